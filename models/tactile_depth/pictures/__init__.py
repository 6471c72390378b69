# SPDX-License-Identifier: Apache-2.0
"""Pictures of any source: on the grid, refused, or doubted.

`reference_check` checks pictures without contact, `picture_check` a picture with its reference, `light_check` what is
left after the light gains. The limit of each check stands between what was measured on right pictures (45 presses of a
GelSight Mini and their reference, the same in light times 0.8 to 1.1 and 5 % off in two colours, drawn contacts) and on
wrong ones made from them; both stand beside it. docs/light.md lists what is refused and warned of.
"""
