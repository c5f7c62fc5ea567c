# What `./run` makes on a fresh Debian 12, as an image: the locked packages, drivers that draw, compiled kernels.
#   docker build -t hazard_ms .                       without a GPU
#   docker build --target gpu -t hazard_ms:gpu .      for NVIDIA GPUs, with their container toolkit
#   docker run --rm -v "$PWD":/data --user "$(id -u)" hazard_ms [demo | hazard-ms ... | python ...]
FROM debian:bookworm-slim AS cpu
COPY . /opt/hazard_ms
ENV HAZARD_MS_HOME=/opt/hazard_ms_home HOME=/tmp
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends python3 python3-pip ca-certificates
RUN /opt/hazard_ms/run python -c "import hazard_ms" && rm -rf /tmp/.cache /var/lib/apt/lists/*
RUN for task in Fire Flood Wind; do \
      /opt/hazard_ms/run python -c "import gymnasium, hazard_ms; env = gymnasium.make('Hazard$task-v1', obs_mode='rgb'); \
        env.reset(seed=0); env.step(env.action_space.sample()); env.close()" || exit 1; \
    done && chmod -R a+rX /opt/hazard_ms /opt/hazard_ms_home
WORKDIR /data
ENTRYPOINT ["/opt/hazard_ms/run"]
CMD ["demo"]

FROM cpu AS gpu
RUN apt-get update -qq \
    && apt-get install -y -qq --no-install-recommends libegl1 libgl1 libglvnd0 libglx0 \
    && rm -rf /var/lib/apt/lists/*
ENV NVIDIA_VISIBLE_DEVICES=all NVIDIA_DRIVER_CAPABILITIES=all

FROM cpu
