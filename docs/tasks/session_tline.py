# task: a model that comes with the program
import tline as tl
scene = tl.examples["cable_rc"]
# task: run it
result = tl.simulate(scene)
# task: its largest value at a place
largest = result.probes["far"].u.max()
# task: a picture of it
result.plot().savefig("picture.png")
# task: another value, and run again
other = tl.simulate(scene.change({"loads.receiver.capacitance": "5 pF"}))
# task: ten values in one picture
prepared = tl.prepare(scene)
runs = {f"{c} pF": prepared.run({"loads.receiver.capacitance": c * 1e-12}) for c in range(1, 11)}
tl.plot(runs, probes=["far"]).savefig("ten.png")
# task: its frequency response
import numpy as np
response = tl.frequency.respond(scene, 2j * np.pi * np.geomspace(1e6, 1e9, 200))["far"].u
# task: a table of pandas
frame = result.to_dataframe()
# task: to a file and back
open("scene.toml", "w").write(scene.to_toml())
again = tl.read("scene.toml")
# task: is it passive?
load = tl.passivity.RationalFunction.from_expression("100/(1 + 100*4p*s)")
proof = tl.passivity.check_line(load, "50 ohm", "1 ns")
