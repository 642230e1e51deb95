from tline.pictures.animation import Animation as Animation, animated as animated
from tline.pictures.bode import plot_misfit as plot_misfit
from tline.pictures.lattice import plot_lattice as plot_lattice
from tline.pictures.map import lines_to_map as lines_to_map, plot_map as plot_map, surges as surges
from tline.pictures.network import plot_network as plot_network
from tline.pictures.path import Route as Route, route as route
from tline.pictures.profile import (
    plot_line_waves as plot_line_waves,
    plot_profile as plot_profile,
    plot_space_time as plot_space_time,
)
from tline.pictures.traces import draw_probes as draw_probes, plot as plot, plot_waves as plot_waves
from tline.style import save_figure as save_figure
