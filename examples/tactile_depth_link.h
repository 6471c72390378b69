/* SPDX-License-Identifier: Apache-2.0 */
/* Host's side of the link of docs/link.md, for programs in C: packets, accesses to registers, depth frames.

   It needs C99 with POSIX, _DEFAULT_SOURCE before the first header, and tactile_depth_tables.h of Pipeline.hardware.
   Begin with a struct link whose first four fields are set and all others are 0. link_client.c is a program with it. */

#ifndef TACTILE_DEPTH_LINK_H
#define TACTILE_DEPTH_LINK_H

#include <poll.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define TACTILE_DEPTH_POLLS 200 /* a read takes milliseconds */
#include "tactile_depth_tables.h"

enum { LINK_ROWS = TACTILE_DEPTH_ROWS, LINK_COLUMNS = TACTILE_DEPTH_COLUMNS, LINK_PIXELS = LINK_ROWS * LINK_COLUMNS };
enum { LINK_ASK = 0x01, LINK_SELECT, LINK_READ, LINK_WRITE, LINK_PICTURE }; /* kinds of packets */
enum { LINK_STATUS = 0x81, LINK_READ_REPLY = 0x83, LINK_WRITE_REPLY, LINK_DEPTH = 0x90, LINK_TRAILER = 0x98 };
enum { LINK_VERSION = 2, LINK_WORDS = 1, LINK_HEADER = 9, LINK_MOST_ACCESSES = 128, LINK_MOST_PIXELS = 256 };
enum { LINK_LONGEST_PIECE = 1398, LINK_LONGEST_BODY = 1388, LINK_FRAME = 22, LINK_FLAGS = 66, LINK_TRAILER_BYTES = 78 };

struct link {
  int in, out;                                /* file descriptors of the line */
  int repeat_ms, repeats;                     /* how long to wait for an answer, and how often to ask */
  const char *failure;                        /* the first one; nothing is sent after it. NULL: none */
  uint8_t bytes[4096];                        /* that came, */
  size_t have;                                /* and their number */
  uint8_t body[LINK_LONGEST_PIECE];           /* kind and fields of the last packet */
  uint8_t request;                            /* number of the last request */
  uint8_t writes[2 + 6 * LINK_MOST_ACCESSES]; /* packet of the register writes that wait, */
  size_t waiting;                             /* and their number */
  unsigned width, bottom_first, resets;       /* of the last status; width 0: none has come */
  uint32_t number, frames;                    /* number of the depth frame that comes; frames that came whole */
  uint8_t values[4 * LINK_PIXELS];            /* bytes of the frame that comes, */
  size_t count;                               /* and their number */
  int32_t codes[LINK_PIXELS];                 /* of the last whole frame, rows from the top, */
  uint32_t frame, flags[3];                   /* its RECORD_FRAME, and RECORD_FLAGS, RECORD_LIGHT and RECORD_PIXELS */
};

static inline int64_t link_now_ms(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Return a little-endian number. */
static inline uint32_t link_get(const uint8_t *at, unsigned bytes)
{
  return bytes ? at[0] | link_get(at + 1, bytes - 1) << 8 : 0;
}

static inline void link_put(uint8_t *at, unsigned bytes, uint32_t value)
{
  for (; bytes; bytes--, value >>= 8)
    *at++ = (uint8_t)value;
}

static inline uint32_t link_crc32(const uint8_t *data, size_t length)
{
  uint32_t crc = 0xFFFFFFFFu, bit;

  for (; length; length--)
    for (crc ^= *data++, bit = 0; bit < 8; bit++)
      crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  return ~crc;
}

/* Encode data without zero bytes, and return how many bytes that takes. */
static inline size_t link_cobs_encode(const uint8_t *data, size_t length, uint8_t *out)
{
  size_t code = 0, end = 1, place; /* of the code byte of a block, of its end, of the data */

  for (place = 0; place < length; place++) {
    if (data[place])
      out[end++] = data[place];
    if (!data[place] || (end - code == 255 && place + 1 < length)) {
      out[code] = (uint8_t)(end - code);
      code = end++;
    }
  }
  out[code] = (uint8_t)(end - code);
  return end;
}

/* Decode bytes without a zero, and return how many they become; 0: they are broken. */
static inline size_t link_cobs_decode(const uint8_t *piece, size_t length, uint8_t *out)
{
  size_t from = 0, to = 0, code;

  for (; from < length; from += code) {
    code = piece[from];
    if (code > length - from)
      return 0;
    memcpy(out + to, piece + from + 1, code - 1);
    to += code - 1;
    if (code < 255 && from + code < length)
      out[to++] = 0;
  }
  return to;
}

/* Write the bytes on the line of a packet, up to LINK_LONGEST_PIECE + 2, and return how many they are. */
static inline size_t link_to_line(const uint8_t *body, size_t length, uint8_t *line)
{
  uint8_t data[LINK_LONGEST_BODY + 4];

  memcpy(data, body, length);
  link_put(data + length, 4, link_crc32(body, length));
  length = link_cobs_encode(data, length + 4, line + 1);
  line[0] = line[length + 1] = 0;
  return length + 2;
}

static inline void link_send(struct link *l, const uint8_t *body, size_t length)
{
  uint8_t line[LINK_LONGEST_PIECE + 2];
  size_t end = link_to_line(body, length, line), at;
  ssize_t sent;

  for (at = 0; at < end && !l->failure; at += (size_t)sent)
    if ((sent = write(l->out, line + at, end - at)) < 0)
      l->failure = "the line takes no bytes";
}

/* Append the values of a packet of depth; a trailer makes them a frame if they are all there and its CRC is right. */
static inline void link_take_depth(struct link *l, size_t length)
{
  const uint8_t *body = l->body;
  uint32_t bytes = (l->width + 7) / 8, sign = 1u << (8 * bytes - 1), number = link_get(body + 1, 4), place;
  size_t size = LINK_PIXELS * bytes, first = (link_get(body + 5, 2) * LINK_COLUMNS + link_get(body + 7, 2)) * bytes;

  if (number != l->number)
    l->count = 0; /* values of two frames never mix */
  l->number = number;
  if (body[0] == LINK_DEPTH + LINK_WORDS && first == l->count && first + length - LINK_HEADER <= size) {
    memcpy(l->values + first, body + LINK_HEADER, length - LINK_HEADER);
    l->count += length - LINK_HEADER;
  }
  if (body[0] != LINK_TRAILER || length != LINK_TRAILER_BYTES || body[7] != LINK_WORDS || (body[13] & 1) != l->bottom_first || l->count != size ||
      link_get(body + 9, 2) != LINK_ROWS || link_get(body + 11, 2) != LINK_COLUMNS ||
      link_get(body + 14, 4) != link_crc32(l->values, size))
    return;
  for (place = 0; place < LINK_PIXELS; place++) {
    uint32_t row = place / LINK_COLUMNS, value = link_get(l->values + place * bytes, bytes) ^ sign;

    row = l->bottom_first ? LINK_ROWS - 1 - row : row;
    l->codes[row * LINK_COLUMNS + place % LINK_COLUMNS] = (int32_t)((int64_t)value - sign);
  }
  l->frame = link_get(body + LINK_FRAME, 4);
  for (place = 0; place < 3; place++)
    l->flags[place] = link_get(body + LINK_FLAGS + 4 * place, 4);
  l->frames++;
  l->count = 0;
}

static inline void link_take_status(struct link *l)
{
  const uint8_t *body = l->body;
  uint32_t resets = link_get(body + 2, 2);

  if (body[1] != LINK_VERSION)
    l->failure = "the device speaks another version of the link";
  else if (link_get(body + 4, 2) != LINK_ROWS || link_get(body + 6, 2) != LINK_COLUMNS)
    l->failure = "the device has another grid than the tables";
  else if (body[8] != (TACTILE_DEPTH_FORMAT & TACTILE_DEPTH_FORMAT_DATA_WIDTH))
    l->failure = "link_unit has another width of codes than the tables: set its DataWidth, or take this build's tables";
  else if ((body[9] & 1) != (TACTILE_DEPTH_DEVICE & TACTILE_DEPTH_DEVICE_SOLVER))
    l->failure = "link_unit has another order of rows than the tables: set its BottomFirst to 1 for the tridiagonal "
                 "solver, to 0 for the spectral one, or take this build's tables";
  else if (l->width && l->resets != resets)
    l->failure = "the device was reset";
  if (l->failure)
    return;
  l->resets = resets;
  l->width = body[8];
  l->bottom_first = body[9] & 1;
}

/* Take what came between two zeros; return the kind of the packet, 0 if it is none. */
static inline int link_take(struct link *l, size_t length)
{
  uint8_t kind;

  length = length <= LINK_LONGEST_PIECE ? link_cobs_decode(l->bytes, length, l->body) : 0;
  if (length < 5 || link_crc32(l->body, length) != 0x2144DF1Cu) /* the CRC of data with its CRC */
    return 0;
  kind = l->body[0];
  if (kind == LINK_STATUS)
    link_take_status(l);
  else if (l->width && length > LINK_HEADER + 4 && kind > LINK_DEPTH && kind <= LINK_TRAILER)
    link_take_depth(l, length - 4);
  return kind;
}

/* Return the kind of the next packet, which is in `body` until the next call; 0: none comes in time. */
static inline int link_packet(struct link *l, int64_t end_ms)
{
  struct pollfd line = {l->in, POLLIN, 0};

  while (!l->failure) {
    uint8_t *zero = memchr(l->bytes, 0, l->have);
    int64_t left = end_ms - link_now_ms();
    ssize_t came;

    if (zero) {
      int kind = link_take(l, (size_t)(zero - l->bytes));

      l->have -= (size_t)(++zero - l->bytes);
      memmove(l->bytes, zero, l->have);
      if (kind)
        return kind;
      continue;
    }
    if (l->have == sizeof l->bytes)
      l->have = 0; /* no packet is so long */
    if (left <= 0 || poll(&line, 1, (int)left) == 0)
      return 0;
    came = read(l->in, l->bytes + l->have, sizeof l->bytes - l->have);
    if (came <= 0)
      l->failure = "the line has ended";
    else
      l->have += (size_t)came;
  }
  return 0;
}

/* Send a packet until an answer of a kind comes that has a value at a place; return 0 if none does. */
static inline int link_ask(struct link *l, const uint8_t *body, size_t length, int kind, int place, uint8_t value)
{
  int tries, came;

  for (tries = 0; tries < l->repeats && !l->failure; tries++) {
    int64_t end_ms = link_now_ms() + l->repeat_ms;

    link_send(l, body, length);
    while ((came = link_packet(l, end_ms)) != 0)
      if (came == kind && l->body[place] == value)
        return 1;
  }
  if (!l->failure)
    l->failure = "the device does not answer";
  return 0;
}

/* Write the registers whose writes wait. */
static inline void link_flush(struct link *l)
{
  size_t count = l->waiting;

  l->waiting = 0;
  l->writes[0] = LINK_WRITE;
  l->writes[1] = ++l->request;
  if (count && link_ask(l, l->writes, 2 + 6 * count, LINK_WRITE_REPLY, 1, l->request) && l->body[2] != count)
    l->failure = "the device refuses to write a register";
}

/* Write a register, at the latest before the next read. */
static inline void link_write(void *context, uint32_t address, uint32_t word)
{
  struct link *l = context;
  uint8_t *at = l->writes + 2 + 6 * l->waiting++;

  link_put(at, 2, address);
  link_put(at + 2, 4, word);
  if (l->waiting == LINK_MOST_ACCESSES)
    link_flush(l);
}

static inline uint32_t link_read(void *context, uint32_t address)
{
  struct link *l = context;
  uint8_t body[4] = {LINK_READ};

  link_flush(l);
  body[1] = ++l->request;
  link_put(body + 2, 2, address);
  if (link_ask(l, body, sizeof body, LINK_READ_REPLY, 1, body[1]) && l->body[2] != 1)
    l->failure = "the device refuses to read a register";
  return l->failure ? 0 : link_get(l->body + 3, 4);
}

#endif
