/* SPDX-License-Identifier: Apache-2.0 */
/* Loads a calibration into a device whose registers are mapped to memory, and sets its thresholds, the least area of a
   contact and DEBOUNCE. The header is in a folder of Pipeline.hardware. For another bus write the two functions that
   access a register. */

#include "tactile_depth_tables.h"

static void write_register(void *context, uint32_t address, uint32_t word)
{
  *(volatile uint32_t *)((char *)context + address) = word;
}

static uint32_t read_register(void *context, uint32_t address)
{
  return *(volatile uint32_t *)((char *)context + address);
}

int load_calibration(void *base)
{
  int result = tactile_depth_load(write_register, read_register, base, TACTILE_DEPTH_ALL_TABLES);

  if (result == TACTILE_DEPTH_LOADED) {
    write_register(base, TACTILE_DEPTH_THRESHOLD_ADDRESS, TACTILE_DEPTH_THRESHOLD);
    write_register(base, TACTILE_DEPTH_OFF_THRESHOLD_ADDRESS, TACTILE_DEPTH_OFF_THRESHOLD);
    write_register(base, TACTILE_DEPTH_AREA_THRESHOLD_ADDRESS, TACTILE_DEPTH_AREA_THRESHOLD);
    write_register(base, TACTILE_DEPTH_MINIMUM_AREA_ADDRESS, TACTILE_DEPTH_MINIMUM_AREA);
    write_register(base, TACTILE_DEPTH_DEBOUNCE_ADDRESS, TACTILE_DEPTH_DEBOUNCE);
  }
  return result;
}
