#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Draws the pictures of docs/scenes.md: one contact sheet, with a floor plan, for every scene in examples/scenes.
#
#   sh docs/draw_scenes.sh [PROGRAM]       PROGRAM: build/bin/holdfast by default
set -eu

cd "$(dirname "$0")/.."
program=${1:-build/bin/holdfast}

for scene in examples/scenes/*.yaml; do
  "$program" simulate "$scene" --preview "docs/images/scenes/$(basename "$scene" .yaml).jpg" --quiet
done
