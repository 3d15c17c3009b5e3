"""The live page and its WebSocket, on one port.

`points` thins samples, `assets` answers requests for the page, `output` sends the stream, `buttons` carries out
commands. The code of the browser is in `page/`: plain modules without a build step, and uPlot for the charts.
"""
