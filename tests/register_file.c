// SPDX-License-Identifier: Apache-2.0
// Registers of a device in memory, by the rules of docs/generated/registers.md, for tests of programs in C.
//
// Every write is printed. A frame begins at the read of TABLE_COMMIT whose number is given, and at the end.

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tactile_depth.h"

#define AT(register) offsetof(tactile_depth_t, register)

enum { TABLES = 4, REFERENCE = 2, ENTRIES = 1 << 15, ADDRESSES = 1 << 10 };

struct entry {
  uint32_t high, low;
};

struct device {
  union {
    tactile_depth_t registers;
    uint32_t words[ADDRESSES / sizeof(uint32_t)];
  };
  uint32_t sizes[TABLES], in_use[TABLES];
  uint32_t frame_at;       // read of TABLE_COMMIT at which a frame begins; 0: none does
  uint32_t capture_reads;  // of REFERENCE_CAPTURE until its capture ends
  uint32_t refused_from;   // write of TABLE_LOW from which on all are refused
  uint32_t commit_reads, stored, refusals;
  struct entry banks[TABLES][2][ENTRIES];
};

static struct device the_device;

static uint32_t selected(const struct device *device)
{
  return device->registers.TABLE_SELECT & TACTILE_DEPTH__TABLE_SELECT__SELECT_bm;
}

static void begin_frame(struct device *device)
{
  for (uint32_t table = 0; table < TABLES; table++)
    device->in_use[table] ^= device->registers.TABLE_COMMIT >> table & 1;
  device->registers.TABLE_COMMIT = 0;
}

static void store(struct device *device, uint32_t word)
{
  uint32_t table = selected(device), index = device->registers.TABLE_INDEX;
  int closed = (device->registers.TABLE_COMMIT >> table & 1) || (table == REFERENCE && device->capture_reads);

  if (index >= device->sizes[table] || closed || ++device->stored >= device->refused_from) {
    device->refusals++;
    return;
  }
  device->banks[table][!device->in_use[table]][index] = (struct entry){device->registers.TABLE_HIGH, word};
  device->registers.TABLE_INDEX = (index + 1) % device->sizes[table];
}

uint32_t device_read(void *context, uint32_t address)
{
  struct device *device = context;

  if (address == AT(TABLE_COMMIT) && ++device->commit_reads == device->frame_at)
    begin_frame(device);
  if (address == AT(REFERENCE_CAPTURE) && device->capture_reads && --device->capture_reads == 0) {
    device->registers.REFERENCE_CAPTURE = 0;
    device->registers.TABLE_COMMIT |= TACTILE_DEPTH__TABLE_COMMIT__REFERENCE_bm;
  }
  return address == AT(TABLE_SIZE) ? device->sizes[selected(device)] : device->words[address / sizeof(uint32_t)];
}

void device_write(void *context, uint32_t address, uint32_t word)
{
  struct device *device = context;

  printf("write 0x%x 0x%x\n", address, word);
  switch (address) {
  case AT(TABLE_LOW):
    store(device, word);
    break;
  case AT(TABLE_COMMIT):
    for (uint32_t table = 0; table < TABLES; table++)
      if (device->sizes[table])
        device->registers.TABLE_COMMIT |= word & 1u << table;
    break;
  case AT(TABLE_SELECT):
  case AT(TABLE_INDEX):
  case AT(TABLE_HIGH):
  case AT(PITCH):
  case AT(SLOPE_LIMIT):
    device->words[address / sizeof(uint32_t)] = word;
    break;
  default:  // a register that no loader of tables has to write
    device->refusals++;
  }
}

// Return the context of a device that is set up by words NAME=VALUE; a number names the register at that address.
void *device_begin(int count, char **words)
{
  struct device *device = &the_device;

  device->refused_from = UINT32_MAX;
  for (int place = 0; place < count; place++) {
    const char *name = strtok(words[place], "="), *value = strtok(NULL, "=");
    uint32_t number = (uint32_t)strtoul(value, NULL, 0);

    if (!strcmp(name, "frame"))
      device->frame_at = number;
    else if (!strcmp(name, "capture"))
      device->capture_reads = number;
    else if (!strcmp(name, "refused"))
      device->refused_from = number;
    else if (!strncmp(name, "size", 4))
      device->sizes[strtoul(name + 4, NULL, 0)] = number;
    else
      device->words[strtoul(name, NULL, 0) / sizeof(uint32_t)] = number;
  }
  if (device->capture_reads)
    device->registers.REFERENCE_CAPTURE = TACTILE_DEPTH__REFERENCE_CAPTURE__BUSY_bm;
  return device;
}

// Begin a frame, and print the tables that it uses.
void device_end(void *context)
{
  struct device *device = context;

  begin_frame(device);
  for (uint32_t table = 0; table < TABLES; table++)
    for (uint32_t index = 0; index < device->sizes[table]; index++) {
      struct entry entry = device->banks[table][device->in_use[table]][index];

      printf("entry %u 0x%x 0x%x\n", table, entry.high, entry.low);
    }
  printf("refusals %u\n", device->refusals);
}
