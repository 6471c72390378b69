/* SPDX-License-Identifier: Apache-2.0 */
/* Results of tactile_depth_load. */
enum tactile_depth_result {
  TACTILE_DEPTH_LOADED = 0,
  TACTILE_DEPTH_NO_DEVICE,     /* ID: there is no tactile_depth at these addresses */
  TACTILE_DEPTH_OTHER_GRID,    /* GRID: the device has other rows or columns */
  TACTILE_DEPTH_OTHER_FORMAT,  /* FORMAT: words of the device have other formats */
  TACTILE_DEPTH_OTHER_BUILD,   /* DEVICE: another solver, boundary, gradient model or option; lanes may differ */
  TACTILE_DEPTH_OTHER_UNIT,    /* DEPTH_UNIT, SLOPE_UNIT: codes of the device have other units */
  TACTILE_DEPTH_OTHER_NUMBERS, /* ARITHMETIC: the device computes with other numbers */
  TACTILE_DEPTH_OTHER_SIZE,    /* TABLE_SIZE: a table of the device has another number of entries */
  TACTILE_DEPTH_STAYS_PENDING, /* TABLE_COMMIT: no frame took an earlier table, or a capture has not ended */
  TACTILE_DEPTH_REFUSED,       /* TABLE_INDEX: the device did not take every entry of a table */
  TACTILE_DEPTH_OTHER_WINDOW   /* CAMERA_PICTURE, CAMERA_WINDOW, CAMERA_WINDOW_SIZE: the pitch is of another window */
};

/* Reads of TABLE_COMMIT before TACTILE_DEPTH_STAYS_PENDING. The bits read 0 at the latest when the next frame begins. */
#ifndef TACTILE_DEPTH_POLLS
#define TACTILE_DEPTH_POLLS 1000000
#endif

/* Accesses of 32 bits to a register. `address` is a byte address of the register port, from 0. */
typedef void (*tactile_depth_write)(void *context, uint32_t address, uint32_t word);
typedef uint32_t (*tactile_depth_read)(void *context, uint32_t address);

/* Return TACTILE_DEPTH_LOADED if the device is a build of the configuration of this file. */
static inline int tactile_depth_check(tactile_depth_write write, tactile_depth_read read, void *context)
{
  uint32_t place;

  if (read(context, TACTILE_DEPTH_ID_ADDRESS) != TACTILE_DEPTH_ID)
    return TACTILE_DEPTH_NO_DEVICE;
  if (read(context, TACTILE_DEPTH_GRID_ADDRESS) != TACTILE_DEPTH_GRID)
    return TACTILE_DEPTH_OTHER_GRID;
  if (read(context, TACTILE_DEPTH_FORMAT_ADDRESS) != TACTILE_DEPTH_FORMAT)
    return TACTILE_DEPTH_OTHER_FORMAT;
  if ((read(context, TACTILE_DEPTH_DEVICE_ADDRESS) & TACTILE_DEPTH_DEVICE_MASK) != TACTILE_DEPTH_DEVICE)
    return TACTILE_DEPTH_OTHER_BUILD;
  if (read(context, TACTILE_DEPTH_DEPTH_UNIT_ADDRESS) != TACTILE_DEPTH_DEPTH_UNIT ||
      read(context, TACTILE_DEPTH_SLOPE_UNIT_ADDRESS) != TACTILE_DEPTH_SLOPE_UNIT)
    return TACTILE_DEPTH_OTHER_UNIT;
  if (read(context, TACTILE_DEPTH_ARITHMETIC_ADDRESS) != TACTILE_DEPTH_ARITHMETIC)
    return TACTILE_DEPTH_OTHER_NUMBERS;
  for (place = 0; place < TACTILE_DEPTH_TABLES; place++) {
    write(context, TACTILE_DEPTH_TABLE_SELECT_ADDRESS, tactile_depth_tables[place].select);
    if (read(context, TACTILE_DEPTH_TABLE_SIZE_ADDRESS) != tactile_depth_tables[place].entries)
      return TACTILE_DEPTH_OTHER_SIZE;
  }
#ifdef TACTILE_DEPTH_CAMERA_PICTURE
  if (read(context, TACTILE_DEPTH_CAMERA_PICTURE_ADDRESS) != TACTILE_DEPTH_CAMERA_PICTURE ||
      read(context, TACTILE_DEPTH_CAMERA_WINDOW_ADDRESS) != TACTILE_DEPTH_CAMERA_WINDOW ||
      read(context, TACTILE_DEPTH_CAMERA_WINDOW_SIZE_ADDRESS) != TACTILE_DEPTH_CAMERA_WINDOW_SIZE)
    return TACTILE_DEPTH_OTHER_WINDOW;
#endif
  return TACTILE_DEPTH_LOADED;
}

/* Wait until the tables of some bits of TABLE_COMMIT can be written. */
static inline int tactile_depth_wait(tactile_depth_read read, void *context, uint32_t commit)
{
  uint32_t poll;

  /* The captures come first, because the end of one sets a bit of TABLE_COMMIT. */
  for (poll = 0; poll < TACTILE_DEPTH_POLLS; poll++)
    if (!(read(context, TACTILE_DEPTH_REFERENCE_CAPTURE_ADDRESS) & TACTILE_DEPTH_REFERENCE_CAPTURE_BUSY) &&
        !(read(context, TACTILE_DEPTH_ZERO_CAPTURE_ADDRESS) & TACTILE_DEPTH_ZERO_CAPTURE_BUSY) &&
        !(read(context, TACTILE_DEPTH_TABLE_COMMIT_ADDRESS) & commit))
      return TACTILE_DEPTH_LOADED;
  return TACTILE_DEPTH_STAYS_PENDING;
}

/* Write every entry of a table into its free bank. */
static inline int tactile_depth_write_table(
    tactile_depth_write write, tactile_depth_read read, void *context, const struct tactile_depth_table *table)
{
  const uint32_t *word = table->words;
  uint32_t entry;

  write(context, TACTILE_DEPTH_TABLE_SELECT_ADDRESS, table->select);
  write(context, TACTILE_DEPTH_TABLE_INDEX_ADDRESS, 0);
  for (entry = 0; entry < table->entries; entry++) {
    if (entry == table->entries - 1 && read(context, TACTILE_DEPTH_TABLE_INDEX_ADDRESS) != entry)
      return TACTILE_DEPTH_REFUSED; /* TABLE_INDEX stays where it is at a write that is refused */
    if (table->words_of_entry == 2)
      write(context, TACTILE_DEPTH_TABLE_HIGH_ADDRESS, *word++);
    write(context, TACTILE_DEPTH_TABLE_LOW_ADDRESS, *word++); /* stores the entry and moves on */
  }
  return read(context, TACTILE_DEPTH_TABLE_INDEX_ADDRESS) ? TACTILE_DEPTH_REFUSED : TACTILE_DEPTH_LOADED;
}

/* Load the tables whose bits of TABLE_COMMIT are in `commit`, such as TACTILE_DEPTH_ALL_TABLES.

   The next frame that begins uses all of them. After another result than TACTILE_DEPTH_LOADED, frames use the tables
   that they used before. Frames may stream meanwhile. Do not start a capture meanwhile. */
static inline int tactile_depth_load(
    tactile_depth_write write, tactile_depth_read read, void *context, uint32_t commit)
{
  uint32_t place;
  int result = tactile_depth_check(write, read, context);

  if (result == TACTILE_DEPTH_LOADED)
    result = tactile_depth_wait(read, context, commit);
  for (place = 0; place < TACTILE_DEPTH_TABLES && result == TACTILE_DEPTH_LOADED; place++)
    if (tactile_depth_tables[place].commit & commit)
      result = tactile_depth_write_table(write, read, context, &tactile_depth_tables[place]);
  if (result == TACTILE_DEPTH_LOADED) {
    write(context, TACTILE_DEPTH_PITCH_ADDRESS, TACTILE_DEPTH_PITCH);
    write(context, TACTILE_DEPTH_SLOPE_LIMIT_ADDRESS, TACTILE_DEPTH_SLOPE_LIMIT);
    write(context, TACTILE_DEPTH_TABLE_COMMIT_ADDRESS, commit & TACTILE_DEPTH_ALL_TABLES);
  }
  return result;
}

/* Return the bits of the tables of this file that frames use: those that were loaded, from the first frame behind
   tactile_depth_load to the next capture or load of another program. */
static inline uint32_t tactile_depth_holds(tactile_depth_write write, tactile_depth_read read, void *context)
{
  uint32_t place, held = 0;

  for (place = 0; place < TACTILE_DEPTH_TABLES; place++) {
    write(context, TACTILE_DEPTH_TABLE_SELECT_ADDRESS, tactile_depth_tables[place].select);
    if (read(context, TACTILE_DEPTH_TABLE_SIGNATURE_ADDRESS) == tactile_depth_tables[place].signature)
      held |= tactile_depth_tables[place].commit;
  }
  return held;
}
