"""The parts of the exercise as Modelica text, with one convention of signs; the tests solve these very equations.

A flange carries the belt's speed v, positive from spool 1 to spool 2, and the force f on the component in that sense.
"""

DRIVE = """\
model Drive "spool on a motor's shaft"
  parameter Real J, B, r;
  parameter Real sign "-1 for spool 1, which T > 0 brakes; +1 for spool 2, which T > 0 drives";
  input Real T "torque, N m";
  Flange belt;
  Real phi, w;
equation
  der(phi) = w;
  belt.v = r*w;
  J*der(w) = sign*T - B*w + r*belt.f;
end Drive;"""

BELT = """\
model Belt "massless, elastic and damped; a is its end at spool 1"
  parameter Real K, B;
  Flange a, b;
  Real e "elongation, m";
  Real F "tension, N";
equation
  der(e) = b.v - a.v;
  F = K*e + B*der(e);
  a.f = -F;
  b.f = F;
end Belt;"""

PULLEY = """\
model Pulley "massless, on a spring; x_k > 0 away from the spools"
  parameter Real k, theta;
  Flange a, b;
  Real x_k, v_k, F, F_k;
equation
  der(x_k) = v_k;
  a.v - b.v = 2*v_k*cos(theta);
  F_k = -k*x_k;
  F_k = 2*F*cos(theta);
  a.f = -F;
  b.f = F;
end Pulley;"""

ASSEMBLY = """\
model CoupledDrives
  Drive drive1(sign = -1), drive2(sign = 1);
  Belt belt1, belt2;
  Pulley pulley;
equation
  connect(drive1.belt, belt1.a);
  connect(belt1.b, pulley.a);
  connect(pulley.b, belt2.a);
  connect(belt2.b, drive2.belt);
end CoupledDrives;"""
