# SPDX-License-Identifier: Apache-2.0
"""A farm of real processes on this machine, museums that look at every pixel, and what can go wrong between them."""
