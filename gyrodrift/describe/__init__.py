"""Description of a recorded session: clocks, missing samples, rests, noise, yaw; as text, picture and page."""
