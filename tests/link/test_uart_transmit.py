# SPDX-License-Identifier: Apache-2.0
"""uart_transmit: RTL against the model."""

from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Divider": 4}, on=BOTH), Structure({"Divider": 33}, late=BOTH))
