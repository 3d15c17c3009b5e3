"""A page that shows how the gyro is, and the WebSocket that it listens to, on one port.

`points` thins samples, `assets` answers requests for the page, `output` sends to those who look. What runs in the
browser stands in `page/`: plain modules without a build step, and uPlot for the charts.
"""
