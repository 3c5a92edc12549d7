# SPDX-License-Identifier: BSD-3-Clause
# Holdfast on Debian 12: the program and the Python package, installed from the Debian packages that the first stage
# builds. docs/install.md says how to use it.
#
#   docker build --tag holdfast .
#   docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" holdfast run demo.yaml --output out
FROM debian:bookworm-slim AS build
# Alone, so that a change of the sources does not install everything anew.
COPY cmake/install_dependencies.sh /tmp/install_dependencies.sh
RUN sh /tmp/install_dependencies.sh --python && rm -rf /var/lib/apt/lists/*
COPY . /holdfast
WORKDIR /holdfast
RUN cmake --preset release -DHOLDFAST_UNITY=ON -DHOLDFAST_BUILD_TESTS=OFF -DHOLDFAST_BUILD_EXAMPLES=OFF \
      -DHOLDFAST_PYTHON=ON -DHOLDFAST_PYTHON_PACKAGE=ON \
 && cmake --build build --parallel "$(nproc)" \
 && cpack -G DEB -B /packages --config build/CPackConfig.cmake

FROM debian:bookworm-slim
COPY --from=build /packages/*.deb /packages/
# Without the headers; dpkg's packages bring the libraries that they need and nothing else.
RUN rm /packages/libholdfast-dev_*.deb \
 && apt-get update \
 && apt-get install --yes --no-install-recommends /packages/*.deb \
 && rm -rf /packages /var/lib/apt/lists/*
USER 1000:1000
WORKDIR /work
ENTRYPOINT ["holdfast"]
CMD ["--help"]
