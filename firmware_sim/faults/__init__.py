"""What goes wrong between a gyro and its reader, scripted in time; rooms by level: measurements, frames, cable."""
