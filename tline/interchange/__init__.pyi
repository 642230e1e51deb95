from tline.interchange.any_file import read as read
from tline.interchange.netlist_text import spice_text as spice_text
from tline.interchange.spice import read_spice as read_spice
from tline.interchange.water_scene import read_inp as read_inp
