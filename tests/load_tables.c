/* SPDX-License-Identifier: Apache-2.0 */
/* Loads tables into the device of register_file.c: load_tables <bits of TABLE_COMMIT> [NAME=VALUE ..] */

#include <stdio.h>
#include <stdlib.h>

#define TACTILE_DEPTH_POLLS 100
#include "tactile_depth_tables.h"

uint32_t device_read(void *context, uint32_t address);
void device_write(void *context, uint32_t address, uint32_t word);
void *device_begin(int count, char **words);
void device_end(void *context);

int main(int count, char **words)
{
  uint32_t tables = (uint32_t)strtoul(words[1], NULL, 0);
  void *device = device_begin(count - 2, words + 2);

  printf("result %d\n", tactile_depth_load(device_write, device_read, device, tables));
  device_end(device);
  return 0;
}
