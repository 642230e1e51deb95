package CoupledDrives "two spools, an elastic belt, and a jockey pulley on a spring"
  model Drive "torque on a spool, which moves the belt"
    import Modelica.Mechanics.Rotational;
    import Modelica.Mechanics.Translational;
    parameter Modelica.Units.SI.Inertia J = {J1};
    parameter Modelica.Units.SI.RotationalDampingConstant B = {B1};
    parameter Modelica.Units.SI.Radius r = {r1};
    Modelica.Blocks.Interfaces.RealInput T "torque, N.m";
    Translational.Interfaces.Flange_b flange_b "the belt";
    Rotational.Sources.Torque torque;
    Rotational.Components.Inertia inertia(J = J);
    Rotational.Components.Damper damper(d = B);
    Rotational.Components.Fixed fixed;
    Rotational.Components.IdealGearR2T gear(ratio = 1/r);
  equation
    connect(T, torque.tau);
    connect(torque.flange, inertia.flange_a);
    connect(inertia.flange_b, gear.flangeR);
    connect(damper.flange_a, inertia.flange_b);
    connect(damper.flange_b, fixed.flange);
    connect(gear.flangeT, flange_b);
  end Drive;

  model Belt "a piece of belt without mass"
    extends Modelica.Mechanics.Translational.Components.SpringDamper(c = {K1}, d = {D1});
  end Belt;

  model Pulley "without mass, on a spring; xk > 0 away from the spools"
    extends Modelica.Mechanics.Translational.Interfaces.PartialTwoFlanges;
    parameter Modelica.Units.SI.TranslationalSpringConstant k = {k};
    parameter Modelica.Units.SI.Angle theta = {theta};
    Modelica.Units.SI.Velocity v1, v2, vk;
    Modelica.Units.SI.Position xk(start = 0, fixed = true);
    Modelica.Units.SI.Force F1, F2, Fk;
  equation
    v1 = der(flange_a.s);
    v2 = der(flange_b.s);
    v1 - v2 = 2*vk*cos(theta);
    vk = der(xk);
    Fk = k*xk;
    F1 = Fk/(2*cos(theta));
    F2 = F1;
    flange_a.f = F1;
    flange_b.f = -F2;
  end Pulley;

  partial model Assembly "all parts; T1 brakes spool 1, T2 drives spool 2"
    Drive drive1;
    Drive drive2(J = {J2}, B = {B2}, r = {r2});
    Belt belt1;
    Belt belt2(c = {K2}, d = {D2});
    Pulley pulley;
  equation
    connect(drive1.flange_b, belt1.flange_a);
    connect(belt1.flange_b, pulley.flange_a);
    connect(pulley.flange_b, belt2.flange_a);
    connect(belt2.flange_b, drive2.flange_b);
  end Assembly;

  model WithPorts "inputs T1, T2 and output xk, to be linearised"
    extends Assembly;
    Modelica.Blocks.Interfaces.RealInput T1;
    Modelica.Blocks.Interfaces.RealInput T2;
    Modelica.Blocks.Interfaces.RealOutput y;
    Modelica.Blocks.Math.Gain turned(k = -1) "T1 > 0 brakes";
  equation
    connect(T1, turned.u);
    connect(turned.y, drive1.T);
    connect(T2, drive2.T);
    y = pulley.xk;
  end WithPorts;

  model Controlled "PI controllers of belt speed and tension, behind a decoupler"
    extends Assembly;
    parameter Real speed_set = {speed} "m/s";
    parameter Real tension_set = {tension} "N";
    Modelica.Blocks.Continuous.PI speed(k = {speed_gain}, T = {speed_time});
    Modelica.Blocks.Continuous.PI tension(k = {tension_gain}, T = {tension_time});
  equation
    speed.u = speed_set - (pulley.v1 + pulley.v2)/2;
    tension.u = tension_set + pulley.F1 "a tight belt has F1 < 0";
    drive1.T = -(tension.y - speed.y)/2 "T1 > 0 brakes";
    drive2.T = (tension.y + speed.y)/2;
  end Controlled;
end CoupledDrives;
