model BeltAxis "A linear axis: cascade controller, motor, elastic belt, carriage"
  parameter Real position_gain(unit = "1/s") = 50 "Kv of the position controller";
  parameter Real velocity_time_constant(unit = "s") = 0.003 "Tv of the velocity loop, with a stiff belt";
  parameter Real feedforward = 1 "Share of the setpoint's velocity";
  parameter Real motor_mass(unit = "kg") = 80 "The inertia of motor and pulleys, as a mass at the belt";
  parameter Real carriage_mass(unit = "kg") = 40 "Carriage with tool";
  parameter Real belt_stiffness(unit = "N/m") = 2e5 "Between motor and carriage";
  parameter Real belt_damping(unit = "N.s/m") = 60 "Between motor and carriage";

  input Real setpoint_time(unit = "s", start = 0) "The end of the communication step";
  input Real setpoint_position(unit = "mm", start = 0) "The setpoint then";
  input Real setpoint_velocity(unit = "mm/s", start = 0) "Its velocity then";
  input Real setpoint_acceleration(unit = "mm/s2", start = 0) "Its acceleration then";

  output Real position(unit = "mm") "Of the carriage";
  output Real velocity(unit = "mm/s") "Of the carriage";
  output Real motor_force(unit = "N") "The motor's torque, as a force at the belt";
  output Real belt_force(unit = "N") "On the carriage";
protected
  Real clock(unit = "s", start = 0, fixed = true) "rumoca 0.9.12 exports no model that contains the variable time";
  Real elapsed(unit = "s") "Negative within the step";
  Real desired_position(unit = "mm");
  Real desired_velocity(unit = "mm/s");
  Real velocity_command(unit = "mm/s");
  Real motor_position(unit = "mm", start = 0, fixed = true);
  Real motor_velocity(unit = "mm/s", start = 0, fixed = true);
  Real carriage_position(unit = "mm", start = 0, fixed = true);
  Real carriage_velocity(unit = "mm/s", start = 0, fixed = true);
equation
  // The drive interpolates within the step: an input is constant there.
  der(clock) = 1;
  elapsed = clock - setpoint_time;
  desired_velocity = setpoint_velocity + setpoint_acceleration*elapsed;
  desired_position = setpoint_position + elapsed*(setpoint_velocity + desired_velocity)/2;

  // Cascade: a position controller around a velocity controller, both with the motor's encoder.
  velocity_command = feedforward*desired_velocity + position_gain*(desired_position - motor_position);
  motor_force = (motor_mass + carriage_mass)/velocity_time_constant*(velocity_command - motor_velocity)/1000;

  // Mechanics: forces in N are masses in kg times m/s2.
  belt_force = (belt_stiffness*(motor_position - carriage_position)
    + belt_damping*(motor_velocity - carriage_velocity))/1000;
  der(motor_position) = motor_velocity;
  der(motor_velocity) = 1000*(motor_force - belt_force)/motor_mass;
  der(carriage_position) = carriage_velocity;
  der(carriage_velocity) = 1000*belt_force/carriage_mass;
  position = carriage_position;
  velocity = carriage_velocity;
end BeltAxis;
