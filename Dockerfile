# gyrodrift with the live page, MQTT, NMEA and Prometheus:
#   docker build --tag gyrodrift .
#   docker run --rm --interactive --tty gyrodrift                        (the demo, without hardware)
#   docker run --rm --device /dev/ttyUSB0 --volume /dev/serial:/dev/serial:ro --group-add dialout \
#     --publish 127.0.0.1:8117:8117 gyrodrift serve --port /dev/ttyUSB0 --output web:host=0.0.0.0
FROM python:3.13-slim-bookworm AS build
RUN pip install --no-cache-dir uv==0.13.9
WORKDIR /source
COPY pyproject.toml uv.lock README.md LICENSE ./
COPY config ./config
COPY firmware_sim ./firmware_sim
COPY gyrodrift ./gyrodrift
ENV UV_PROJECT_ENVIRONMENT=/opt/gyrodrift
RUN uv sync --locked --no-editable --no-cache --extra websocket --extra mqtt --extra nmea --extra prometheus

FROM python:3.13-slim-bookworm
COPY --from=build /opt/gyrodrift /opt/gyrodrift
RUN useradd --uid 1000 --create-home --groups dialout gyrodrift
ENV PATH=/opt/gyrodrift/bin:$PATH
USER 1000
WORKDIR /home/gyrodrift
EXPOSE 8117
ENTRYPOINT ["gyrodrift"]
CMD ["demo"]
