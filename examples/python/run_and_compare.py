# SPDX-License-Identifier: BSD-3-Clause
"""Runs the demonstration twice, with and without filters, and prints how far each path is from the truth.

python3 examples/python/run_and_compare.py [DURATION_IN_SECONDS]
"""
import pathlib
import sys

import holdfast

demo = pathlib.Path(__file__).parent.parent / "configs" / "demo.yaml"
duration = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
for name, filters in {"static": [], "with masks": ["semantic_mask"]}.items():
    result = holdfast.run(demo, {"source.simulated.duration": duration, "filters": filters, "observers": []})
    assert result.evaluation is not None  # the simulation knows its truth
    print(f"{name:12} ATE RMSE {1e3 * result.evaluation.ate_rmse:.1f} mm, coverage {100 * result.coverage:.0f} %")
