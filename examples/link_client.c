/* SPDX-License-Identifier: Apache-2.0 */
/* Loads a calibration into a device on a serial line, sends a picture until the light gains have settled on it, writes
   its heights in mm, and says what is uncertain.

     gcc -std=c99 -Wall -Werror -Ihardware examples/link_client.c -o link_client
     ./link_client /dev/ttyUSB0 picture.rgb heights.f32

   `hardware` is a folder of Pipeline.hardware. The picture has bytes of red, green and blue for each pixel of the grid,
   the file of heights a float; rows go from the top. With - for the port, standard input and output are the line.

   It does not look at the picture itself: td.Device in Python does, and refuses one that is black, or warns of clipped
   or exchanged colours. */

#define _DEFAULT_SOURCE /* POSIX, flock and cfmakeraw in spite of -std=c99 */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include "tactile_depth_link.h"

#ifndef B3000000
#define B3000000 3000000 /* where speeds are numbers */
#endif

enum { TRIES = 5, CAMERA_MS = 2000 }; /* in which the slowest camera gives a picture */
enum { GAIN_OF_1 = 0x8000, LEAST_GAIN = 0x4000, LARGEST_GAIN = 0xFFFF }; /* of the light */
enum { STILL = 4, MOST_PICTURES = 20 };  /* gains that move by less than 2^-13 have settled */

#define CAMERA "the device has a camera of its own: stop the camera, or take its depth with td.Device in Python"

static void open_line(struct link *l, const char *port)
{
  struct termios line;

  if (!strcmp(port, "-")) {
    l->out = 1;
    l->repeat_ms = 2000; /* a simulated device is slow, and may have to be built */
    l->repeats = 60;
    return;
  }
  l->repeat_ms = 50;
  l->repeats = 60;
  l->in = l->out = open(port, O_RDWR | O_NOCTTY);
  if (l->in >= 0 && flock(l->in, LOCK_EX | LOCK_NB) < 0 && errno == EWOULDBLOCK) {
    close(l->in);
    l->in = -1;
    errno = EBUSY;
  }
  if (l->in < 0 || tcgetattr(l->in, &line) < 0) {
    l->failure = errno == EBUSY ? "the port is in use by another program: close that one" : "the port cannot be opened";
    return;
  }
  ioctl(l->in, TIOCEXCL); /* for programs that look at no lock */
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  if (cfsetispeed(&line, B3000000) < 0 || cfsetospeed(&line, B3000000) < 0 || tcsetattr(l->in, TCSAFLUSH, &line) < 0)
    l->failure = "the port does not have 3,000,000 baud";
}

/* Ask for the status, and select depth in words. */
static void begin(struct link *l)
{
  const uint8_t ask[] = {LINK_ASK}, select[] = {LINK_SELECT, LINK_WORDS, 0};

  if (link_ask(l, ask, sizeof ask, LINK_STATUS, 1, LINK_VERSION))
    link_ask(l, select, sizeof select, LINK_STATUS, 10, LINK_WORDS);
}

/* Refuse a device whose last frame has another number: a camera's frames would pass for those of the picture. */
static void require_last(struct link *l, uint32_t number)
{
  if (link_read(l, TACTILE_DEPTH_RECORD_FRAME_ADDRESS) != number && !l->failure)
    l->failure = CAMERA;
}

/* Refuse a device that makes frames before a picture is sent. */
static void require_silence(struct link *l)
{
  uint32_t number = link_read(l, TACTILE_DEPTH_RECORD_FRAME_ADDRESS);
  int64_t end_ms = link_now_ms() + CAMERA_MS;

  while (link_packet(l, end_ms))
    ;
  require_last(l, number);
}

/* Send a picture, again if need be, until its depth frame comes: the one with the next number. */
static void send_picture(struct link *l, const uint8_t *picture)
{
  uint32_t place, count, frames, next, tries = 0;
  uint8_t body[LINK_HEADER + 3 * LINK_MOST_PIXELS] = {LINK_PICTURE};

  do {
    int64_t begin_ms;

    next = link_read(l, TACTILE_DEPTH_RECORD_FRAME_ADDRESS) + 1;
    frames = l->frames;
    begin_ms = link_now_ms();
    link_put(body + 1, 4, (uint32_t)begin_ms); /* a number that the picture before did not have */
    for (place = 0; place < LINK_PIXELS; place += count) {
      count = LINK_PIXELS - place < LINK_MOST_PIXELS ? LINK_PIXELS - place : LINK_MOST_PIXELS;
      link_put(body + 5, 2, place / LINK_COLUMNS);
      link_put(body + 7, 2, place % LINK_COLUMNS);
      memcpy(body + LINK_HEADER, picture + 3 * place, 3 * count);
      link_send(l, body, LINK_HEADER + 3 * count);
    }
    while (l->frames == frames && link_packet(l, begin_ms + (int64_t)l->repeat_ms * l->repeats))
      ;
  } while (l->frames == frames && ++tries < TRIES && !l->failure);
  if (!l->failure)
    l->failure = l->frames == frames ? "no depth frame comes" : l->frame != next ? CAMERA : NULL;
}

/* Load tables and thresholds; they are in use from the next picture on. */
static void load(struct link *l, const uint8_t *picture)
{
  static const char *const results[] = {
      NULL, "no tactile_depth answers", "the device has another grid", "the device has other formats",
      "the device is another build", "the device has other units",
      "the device computes with other numbers: build it for this calibration",
      "the device has a table of another size", "tables stay pending", "the device did not take every entry",
      "the device has another camera window: set CAMERA_PICTURE and CAMERA_WINDOW, or build it for these tables"};
  int result = tactile_depth_load(link_write, link_read, l, TACTILE_DEPTH_ALL_TABLES);

  if (result == TACTILE_DEPTH_STAYS_PENDING && !l->failure) { /* of a program before, until a frame takes them */
    send_picture(l, picture);
    result = tactile_depth_load(link_write, link_read, l, TACTILE_DEPTH_ALL_TABLES);
  }
  if (!l->failure)
    l->failure = results[result];
  link_write(l, TACTILE_DEPTH_THRESHOLD_ADDRESS, TACTILE_DEPTH_THRESHOLD);
  link_write(l, TACTILE_DEPTH_OFF_THRESHOLD_ADDRESS, TACTILE_DEPTH_OFF_THRESHOLD);
  link_write(l, TACTILE_DEPTH_AREA_THRESHOLD_ADDRESS, TACTILE_DEPTH_AREA_THRESHOLD);
  link_write(l, TACTILE_DEPTH_MINIMUM_AREA_ADDRESS, TACTILE_DEPTH_MINIMUM_AREA);
  link_write(l, TACTILE_DEPTH_DEBOUNCE_ADDRESS, TACTILE_DEPTH_DEBOUNCE);
  link_write(l, TACTILE_DEPTH_DARK_LEVEL_ADDRESS, 0);
  link_flush(l);
}

/* Say how far the heights of the last frame hold: by its flags, and by STATUS. */
static void say(const struct link *l, uint32_t pictures, const uint32_t *gains, int moved, uint32_t status)
{
  uint32_t flags = l->flags[0], dark = l->flags[2] & TACTILE_DEPTH_RECORD_PIXELS_DARK, steep = l->flags[2] >> 16;
  uint32_t colour;
  int is_clipped = (flags & (TACTILE_DEPTH_RECORD_FLAGS_COLOURS_CLIPPED | TACTILE_DEPTH_RECORD_FLAGS_DEPTH_CLIPPED |
                             TACTILE_DEPTH_RECORD_FLAGS_ZERO_CLIPPED)) != 0;
  int has_resumed = (flags & TACTILE_DEPTH_RECORD_FLAGS_RESUMED) != 0, is_limited = 0;
  int has_flipped = (flags & TACTILE_DEPTH_RECORD_FLAGS_FLIPPED) != 0;
  int has_residual = (flags & TACTILE_DEPTH_RECORD_FLAGS_RESIDUAL) != 0;
  int has_faults = (status & (TACTILE_DEPTH_STATUS_OUT_OF_STEP | TACTILE_DEPTH_STATUS_DEPTH_DROPPED)) != 0;

  fprintf(stderr, "picture sent %u times", pictures);
  if (gains[0])
    fprintf(stderr, ", light gains %.4f %.4f %.4f", gains[0] / (double)GAIN_OF_1, gains[1] / (double)GAIN_OF_1,
            gains[2] / (double)GAIN_OF_1);
  fprintf(stderr, "\n");
  for (colour = 0; colour < 3; colour++)
    is_limited |= gains[colour] && (gains[colour] <= LEAST_GAIN || gains[colour] >= LARGEST_GAIN);
  if (moved || is_limited || is_clipped || has_resumed || has_flipped || has_residual || has_faults || dark || steep)
    fprintf(stderr, "heights are uncertain:%s%s%s%s%s%s%s %u dark pixels, %u steeper than the calibration's\n",
            moved ? " the light gains have not settled," : "", is_limited ? " the light is beyond the light gains," : "",
            is_clipped ? " values were clipped," : "", has_resumed ? " pixels before it were dropped," : "",
            has_flipped ? " a bit of the device had flipped," : "",
            has_residual ? " the depth does not fit its slopes," : "", has_faults ? " STATUS has faults," : "", dark,
            steep);
}

/* Send a picture until its light gains, which begin at 1, have settled: the frame has those that it moves on. */
static void settle(struct link *l, const uint8_t *picture)
{
  uint32_t pictures = 0, gains[3] = {0}, colour, status;
  int moved;

  for (colour = 0; colour < 3; colour++)
    link_write(l, TACTILE_DEPTH_LIGHT_GAIN_RED_ADDRESS + 4 * colour, GAIN_OF_1);
  link_write(l, TACTILE_DEPTH_LIGHT_ADDRESS, TACTILE_DEPTH_LIGHT_FOLLOW); /* with a rate of 0, at once */
  do {
    link_write(l, TACTILE_DEPTH_STATUS_ADDRESS, 0xFFFFFFFFu); /* what is 1 is cleared */
    link_flush(l);
    send_picture(l, picture);
    gains[0] = l->flags[0] >> 16; /* 0: a build without light gains */
    gains[1] = l->flags[1] & TACTILE_DEPTH_RECORD_LIGHT_LIGHT_GAIN_GREEN;
    gains[2] = l->flags[1] >> 16;
    for (colour = 0, moved = 0; colour < 3; colour++) {
      uint32_t next = link_read(l, TACTILE_DEPTH_LIGHT_GAIN_RED_ADDRESS + 4 * colour);

      moved |= (gains[colour] < next ? next - gains[colour] : gains[colour] - next) > STILL;
    }
    status = link_read(l, TACTILE_DEPTH_STATUS_ADDRESS);
  } while (++pictures < MOST_PICTURES && moved && !l->failure);
  if (!l->failure)
    say(l, pictures, gains, moved, status);
}

/* Convert depth codes to heights in mm above the untouched surface: the mean depth that is not above the threshold. */
static void heights(const struct link *l, float *mm)
{
  double sum = 0, count = 0;
  uint32_t place;

  for (place = 0; place < LINK_PIXELS; place++)
    if (l->codes[place] <= (int32_t)TACTILE_DEPTH_THRESHOLD) {
      sum += l->codes[place];
      count++;
    }
  for (place = 0; place < LINK_PIXELS; place++) /* not a number if all are above the threshold */
    mm[place] = (float)(TACTILE_DEPTH_DEPTH_LSB_MM * (l->codes[place] - sum / count));
}

int main(int count, char **words)
{
  static struct link l;
  static uint8_t picture[3 * LINK_PIXELS];
  static float mm[LINK_PIXELS];
  uint32_t place, peak = 0;
  FILE *file;

  if (count != 3 && count != 4) {
    fprintf(stderr, "usage: link_client PORT PICTURE [HEIGHTS]\n");
    return 2;
  }
  signal(SIGPIPE, SIG_IGN); /* a line that ends gives an error */
  file = fopen(words[2], "rb");
  if (!file || fread(picture, sizeof picture, 1, file) != 1 || fgetc(file) != EOF) {
    fprintf(stderr, "%s: no file of %d x %d pixels of 3 bytes\n", words[2], LINK_COLUMNS, LINK_ROWS);
    return 1;
  }
  open_line(&l, words[1]);
  begin(&l);
  require_silence(&l);
  load(&l, picture);
  settle(&l, picture);
  if (!l.failure && tactile_depth_holds(link_write, link_read, &l) != TACTILE_DEPTH_ALL_TABLES)
    l.failure = "the device uses other tables than were loaded: another program writes to it";
  require_last(&l, l.frame);
  if (l.in > 0)
    ioctl(l.in, TIOCNXCL); /* which would last as long as anyone holds the port open */
  if (l.failure) {
    fprintf(stderr, "%s: %s\n", words[1], l.failure);
    return 1;
  }
  heights(&l, mm);
  for (place = 1; place < LINK_PIXELS; place++)
    peak = mm[place] > mm[peak] ? place : peak;
  fprintf(stderr, "peak %.4f mm in row %u, column %u\n", mm[peak], peak / LINK_COLUMNS, peak % LINK_COLUMNS);
  if (count == 3)
    return 0;
  file = fopen(words[3], "wb");
  if (!file || fwrite(mm, sizeof mm, 1, file) != 1 || fclose(file)) {
    fprintf(stderr, "%s cannot be written\n", words[3]);
    return 1;
  }
  return 0;
}
