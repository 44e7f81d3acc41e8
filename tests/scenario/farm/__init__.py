# SPDX-License-Identifier: Apache-2.0
"""A farm of real processes on this machine, museums that check every pixel, and faults between them."""
