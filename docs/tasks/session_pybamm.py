# task: a model that comes with the program
import pybamm
model = pybamm.lithium_ion.SPM()
# task: run it
solution = pybamm.Simulation(model).solve([0, 3600])
# task: its largest value at a place
largest = solution["Voltage [V]"].entries.max()
# task: a picture of it
import matplotlib.pyplot as plt
plt.plot(solution["Time [s]"].entries, solution["Voltage [V]"].entries)
plt.savefig("picture.png")
# task: another value, and run again
values = model.default_parameter_values
values["Current function [A]"] = 0.5
other = pybamm.Simulation(model, parameter_values=values).solve([0, 3600])
# task: ten values in one picture
values["Current function [A]"] = "[input]"
simulation = pybamm.Simulation(model, parameter_values=values)
for k in range(1, 11):
    run = simulation.solve([0, 3600], inputs={"Current function [A]": k / 20})
    plt.plot(run["Time [s]"].entries, run["Voltage [V]"].entries, label=f"{k / 20} A")
plt.savefig("ten.png")
# task: a table of pandas
import pandas as pd
frame = pd.DataFrame(solution.get_data_dict(["Time [s]", "Voltage [V]"]))
# task: to a file and back
solution.save("solution.pkl")
again = pybamm.load("solution.pkl")
