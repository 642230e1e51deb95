# task: run it
import control as ct
import numpy as np
delay = ct.tf(*ct.pade(1e-9, 6))
there = ct.tf([2 / 3], [100 / 3 * 4e-12, 1]) * ct.tf([2 / 3], [1]) * delay
back = ct.tf([-100 / 3 * 4e-12, 1 / 3], [100 / 3 * 4e-12, 1]) * ct.tf([-1 / 3], [1]) * delay * delay
cable = ct.feedback(1, -back) * there * 2
t, u = ct.step_response(cable, np.linspace(0, 12e-9, 500))
# task: its largest value at a place
largest = u.max()
# task: a picture of it
import matplotlib.pyplot as plt
plt.plot(t, u)
plt.savefig("picture.png")
# task: another value, and run again
there = ct.tf([2 / 3], [100 / 3 * 5e-12, 1]) * ct.tf([2 / 3], [1]) * delay
back = ct.tf([-100 / 3 * 5e-12, 1 / 3], [100 / 3 * 5e-12, 1]) * ct.tf([-1 / 3], [1]) * delay * delay
other = ct.step_response(ct.feedback(1, -back) * there * 2, np.linspace(0, 12e-9, 500))
# task: ten values in one picture
for c in range(1, 11):
    rate = 100 / 3 * c * 1e-12
    there = ct.tf([2 / 3], [rate, 1]) * ct.tf([2 / 3], [1]) * delay
    back = ct.tf([-rate, 1 / 3], [rate, 1]) * ct.tf([-1 / 3], [1]) * delay * delay
    plt.plot(*ct.step_response(ct.feedback(1, -back) * there * 2, np.linspace(0, 12e-9, 500)))
plt.savefig("ten.png")
# task: its frequency response
response = cable(2j * np.pi * np.geomspace(1e6, 1e9, 200))
# task: a table of pandas
frame = ct.step_response(cable, t).to_pandas()
