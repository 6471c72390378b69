// SPDX-License-Identifier: Apache-2.0
// Registers of a device in memory, by the rules of docs/registers.md, for tests of programs in C.
//
// Every write is printed. A frame begins at the read of TABLE_COMMIT whose number is given, and at the end.

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tactile_depth.h"

#define AT(register) offsetof(tactile_depth_t, register)
#define FIELD(word, name) (((word) & TACTILE_DEPTH__##name##_bm) >> TACTILE_DEPTH__##name##_bp)

enum { TABLES = 4, ENTRIES = 1 << 15 };

struct entry {
  uint32_t high, low;
};

static uint32_t registers[sizeof(tactile_depth_t) / sizeof(uint32_t)];
static uint32_t sizes[TABLES], in_use[TABLES], frame_at, capture_reads, commit_reads, refused_from, stored, refusals;
static struct entry banks[TABLES][2][ENTRIES];

static uint32_t *at(uint32_t address)
{
  return &registers[address / sizeof(uint32_t)];
}

static void begin_frame(void)
{
  for (uint32_t table = 0; table < TABLES; table++)
    in_use[table] ^= *at(AT(TABLE_COMMIT)) >> table & 1;
  *at(AT(TABLE_COMMIT)) = 0;
}

uint32_t device_read(void *context, uint32_t address)
{
  (void)context;
  if (address == AT(TABLE_COMMIT) && ++commit_reads == frame_at)
    begin_frame();
  if (address == AT(TABLE_SIZE))
    return sizes[FIELD(*at(AT(TABLE_SELECT)), TABLE_SELECT__SELECT)];
  if (address == AT(REFERENCE_CAPTURE) && capture_reads && --capture_reads == 0) {
    *at(address) &= ~TACTILE_DEPTH__REFERENCE_CAPTURE__BUSY_bm;
    *at(AT(TABLE_COMMIT)) |= TACTILE_DEPTH__TABLE_COMMIT__REFERENCE_bm;
  }
  return *at(address);
}

static void store(uint32_t word)
{
  uint32_t table = FIELD(*at(AT(TABLE_SELECT)), TABLE_SELECT__SELECT), *index = at(AT(TABLE_INDEX));
  int closed = *at(AT(TABLE_COMMIT)) >> table & 1;

  closed |= table == 2 && *at(AT(REFERENCE_CAPTURE)) & TACTILE_DEPTH__REFERENCE_CAPTURE__BUSY_bm;
  if (*index >= sizes[table] || closed || ++stored >= refused_from) {
    refusals++;
    return;
  }
  banks[table][!in_use[table]][*index] = (struct entry){*at(AT(TABLE_HIGH)), word};
  *index = (*index + 1) % sizes[table];
}

void device_write(void *context, uint32_t address, uint32_t word)
{
  (void)context;
  printf("write 0x%x 0x%x\n", address, word);
  switch (address) {
  case AT(TABLE_LOW):
    store(word);
    break;
  case AT(TABLE_COMMIT):
    for (uint32_t table = 0; table < TABLES; table++)
      if (sizes[table])
        *at(address) |= word & 1u << table;
    break;
  case AT(TABLE_SELECT):
  case AT(TABLE_INDEX):
  case AT(TABLE_HIGH):
  case AT(PITCH):
    *at(address) = word;
    break;
  default:  // a register that no loader of tables has to write
    refusals++;
  }
}

// Set up the device from words NAME=VALUE; a name that is a number is the address of a register.
void device_begin(int count, char **words)
{
  refused_from = UINT32_MAX;
  for (int place = 0; place < count; place++) {
    char *value = strchr(words[place], '=') + 1;
    uint32_t number = (uint32_t)strtoul(value, NULL, 0);
    if (!strncmp(words[place], "frame=", 6))
      frame_at = number;
    else if (!strncmp(words[place], "capture=", 8))
      capture_reads = number;
    else if (!strncmp(words[place], "refused=", 8))
      refused_from = number;
    else if (!strncmp(words[place], "size", 4))
      sizes[words[place][4] - '0'] = number;
    else
      *at((uint32_t)strtoul(words[place], NULL, 0)) = number;
  }
  if (capture_reads)
    *at(AT(REFERENCE_CAPTURE)) |= TACTILE_DEPTH__REFERENCE_CAPTURE__BUSY_bm;
}

// Begin a frame, and print the tables that it uses.
void device_end(void)
{
  begin_frame();
  for (uint32_t table = 0; table < TABLES; table++)
    for (uint32_t index = 0; index < sizes[table]; index++) {
      struct entry entry = banks[table][in_use[table]][index];
      printf("entry %u 0x%x 0x%x\n", table, entry.high, entry.low);
    }
  printf("refusals %u\npitch %u\n", refusals, *at(AT(PITCH)));
}
