# task: a model that comes with the program
import wntr
network = wntr.network.WaterNetworkModel("Net3")
# task: run it
results = wntr.sim.EpanetSimulator(network).run_sim()
# task: its largest value at a place
largest = results.node["pressure"]["123"].max()
# task: a picture of it
import matplotlib.pyplot as plt
results.node["pressure"]["123"].plot()
plt.savefig("picture.png")
# task: another value, and run again
network.get_link("330").diameter = 0.5
other = wntr.sim.EpanetSimulator(network).run_sim()
# task: ten values in one picture
for k in range(1, 11):
    network.get_link("330").diameter = k / 10
    wntr.sim.EpanetSimulator(network).run_sim().node["pressure"]["123"].plot(label=f"{k / 10} m")
plt.savefig("ten.png")
# task: a table of pandas
frame = results.node["pressure"]
# task: to a file and back
wntr.network.write_inpfile(network, "network.inp")
again = wntr.network.WaterNetworkModel("network.inp")
