"""Facts that a session shows: clock, gaps, rests, noise, spectrum, gravity, reference and temperature."""
