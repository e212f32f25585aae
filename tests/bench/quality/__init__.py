# SPDX-License-Identifier: MIT
"""The rooms of scripts/bench-quality."""
