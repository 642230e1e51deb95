# task: a model that comes with the program
import skrf as rf
from skrf.data import ring_slot as network
# task: run it
import numpy as np
from skrf.media import DefinedGammaZ0
frequency = rf.Frequency(0.001, 20, 2000, unit="GHz")
medium = DefinedGammaZ0(frequency, gamma=1j * 2 * np.pi * frequency.f / 2e8, z0=50)
cable = medium.line(0.2, "m") ** medium.shunt_capacitor(4e-12) ** medium.resistor(100) ** medium.short()
# task: its largest value at a place
largest = abs(cable.s[:, 0, 0]).max()
# task: a picture of it
import matplotlib.pyplot as plt
cable.plot_s_db()
plt.savefig("picture.png")
# task: another value, and run again
other = medium.line(0.2, "m") ** medium.shunt_capacitor(5e-12) ** medium.resistor(100) ** medium.short()
# task: ten values in one picture
for c in range(1, 11):
    load = medium.shunt_capacitor(c * 1e-12) ** medium.resistor(100) ** medium.short()
    (medium.line(0.2, "m") ** load).plot_s_db(label=f"{c} pF")
plt.savefig("ten.png")
# task: its frequency response
response = cable.s[:, 0, 0]
# task: a table of pandas
frame = cable.to_dataframe()
# task: to a file and back
cable.write_touchstone("cable")
again = rf.Network("cable.s1p")
# task: is it passive?
passive = network.is_passive()
