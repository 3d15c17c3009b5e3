"""Programs and headers for microcontrollers, in `files`; none of them runs in this process."""
