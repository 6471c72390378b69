// SPDX-License-Identifier: Apache-2.0
// Poisson solve of frames of N x N (-DN=128, a power of two from 16) in single precision on one core, for make
// baselines: sine transforms down the columns, several columns side by side in a SIMD register, and Thomas's algorithm
// along the rows, several modes side by side. This is the method of hdl/poisson/tridiagonal_solver.sv with rows and
// columns exchanged, which needs half as many transpositions. From the pixels on: slopes from a table of colours first.

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#if defined(__AVX512F__) && N >= 32
#define W 16
#define LIST(F, d) \
  F(0, d), F(1, d), F(2, d), F(3, d), F(4, d), F(5, d), F(6, d), F(7, d), F(8, d), F(9, d), F(10, d), F(11, d), \
      F(12, d), F(13, d), F(14, d), F(15, d)
#elif defined(__AVX__)
#define W 8
#define LIST(F, d) F(0, d), F(1, d), F(2, d), F(3, d), F(4, d), F(5, d), F(6, d), F(7, d)
#else
#define W 4
#define LIST(F, d) F(0, d), F(1, d), F(2, d), F(3, d)
#endif

#define SHORTEST (N & 0x5555 ? 4 : 2)  // length of the last transforms

typedef float vector __attribute__((vector_size(4 * W)));
typedef float loose __attribute__((vector_size(4 * W), aligned(4)));

typedef struct {
  vector re, im;
} pair;  // of complex numbers, of which one part belongs to each of two columns

// Tables, made once.

static float turn[N][6];             // cos and sin of 1, 2 and 3 times 2 pi j / N
static float phase[N / 2 + 1][2];    // cos and sin of pi k / 2N
static int place[N];                 // of frequency k in the order of the transform
static vector coefficient[N / W][N];  // Thomas's algorithm: of modes side by side, along a row
#define STRIDE (N + 2 * W)  // a power of two would put all rows into a few sets of the cache
static float modes[N][STRIDE] __attribute__((aligned(64)));

static int frequency(int at, int length) {
  if (length == 1) return 0;
  int radix = length == 2 ? 2 : 4, part = length / radix;
  return at / part + radix * frequency(at % part, part);
}

void prepare(void) {
  for (int j = 0; j < N; j++) {
    for (int times = 1; times <= 3; times++) {
      turn[j][2 * times - 2] = cos(2 * M_PI * times * j / N);
      turn[j][2 * times - 1] = sin(2 * M_PI * times * j / N);
    }
    place[frequency(j, N)] = j;
  }
  for (int k = 0; k <= N / 2; k++) {
    phase[k][0] = cos(M_PI * k / (2 * N));
    phase[k][1] = sin(M_PI * k / (2 * N));
  }
  for (int k = 0; k < N; k++) {
    double middle = 2 * cos(M_PI * (N - k) / N) - 4, c = 1 / (middle - 1);
    for (int j = 0; j < N; j++) {
      coefficient[k / W][j][k % W] = c;
      c = 1 / (middle - (j == N - 2) - c);
    }
  }
}

// Transform of length N, radix 4, in place; forward with decimation in frequency, backward in time.

#define ALWAYS static inline __attribute__((always_inline))

ALWAYS pair add(pair a, pair b) { return (pair){a.re + b.re, a.im + b.im}; }
ALWAYS pair sub(pair a, pair b) { return (pair){a.re - b.re, a.im - b.im}; }
ALWAYS pair sub_i(pair a, pair b) { return (pair){a.re + b.im, a.im - b.re}; }  // a - i b
ALWAYS pair add_i(pair a, pair b) { return (pair){a.re - b.im, a.im + b.re}; }
ALWAYS pair times(pair a, float c, float s) { return (pair){a.re * c - a.im * s, a.im * c + a.re * s}; }

ALWAYS void forward_4(pair a[4], const float *w) {
  pair even = add(a[0], a[2]), odd = add(a[1], a[3]), left = sub(a[0], a[2]), right = sub(a[1], a[3]);
  a[0] = add(even, odd);
  a[1] = times(sub_i(left, right), w[0], -w[1]);
  a[2] = times(sub(even, odd), w[2], -w[3]);
  a[3] = times(add_i(left, right), w[4], -w[5]);
}

ALWAYS void backward_4(pair a[4], const float *w) {
  pair one = times(a[1], w[0], w[1]), two = times(a[2], w[2], w[3]), three = times(a[3], w[4], w[5]);
  pair even = add(a[0], two), odd = add(one, three), left = sub(a[0], two), right = sub(one, three);
  a[0] = add(even, odd);
  a[1] = add_i(left, right);
  a[2] = sub(even, odd);
  a[3] = sub_i(left, right);
}

ALWAYS void stage(pair *z, int length, int backward) {
  int part = length / 4;
  for (int j = 0; j < part; j++) {
    const float *w = turn[j * (N / length)];
    for (int at = j; at < N; at += length) {
      pair a[4] = {z[at], z[at + part], z[at + 2 * part], z[at + 3 * part]};
      if (backward) backward_4(a, w);
      else forward_4(a, w);
      for (int i = 0; i < 4; i++) z[at + i * part] = a[i];
    }
  }
}

ALWAYS void stage_2(pair *z) {
  for (int at = 0; at < N; at += 2) {
    pair sum = add(z[at], z[at + 1]), difference = sub(z[at], z[at + 1]);
    z[at] = sum;
    z[at + 1] = difference;
  }
}

// Cosine transform of columns with alternating signs, which is the sine transform with the modes in reverse order.
// Sample n of the transform of length N is x[2 n] in its first half, -x[2 (N - 1 - n) + 1] in its second (Makhoul).

ALWAYS pair sample(const float *f, int n) {
  const float *x = f + (n < N / 2 ? 2 * n : 2 * (N - 1 - n) + 1) * N;
  pair both = {*(const loose *)x, *(const loose *)(x + W)};
  return n < N / 2 ? both : (pair){-both.re, -both.im};
}

ALWAYS void put(float *at, vector left, vector right) {
  *(loose *)at = left;
  *(loose *)(at + W) = right;
}

static void columns_forward(const float *f, float *out) {
  static pair z[N];
  for (int j = 0; j < N / 4; j++) {
    pair a[4];
    for (int i = 0; i < 4; i++) a[i] = sample(f, j + i * (N / 4));
    forward_4(a, turn[j]);
    for (int i = 0; i < 4; i++) z[j + i * (N / 4)] = a[i];
  }
  int length = N / 4;
  for (; length >= 4; length /= 4) stage(z, length, 0);
  if (length == 2) stage_2(z);
  // Apart again, and C[k] - i C[N - k] = exp(-i pi k / 2N) V[k].
  put(out, z[place[0]].re, z[place[0]].im);
  for (int k = 1; k <= N / 2; k++) {
    pair p = z[place[k]], q = z[place[N - k]];
    float c = 0.5f * phase[k][0], s = 0.5f * phase[k][1];
    vector left_re = p.re + q.re, left_im = p.im - q.im, right_re = p.im + q.im, right_im = q.re - p.re;
    put(out + k * STRIDE, left_re * c + left_im * s, right_re * c + right_im * s);
    if (k < N / 2) put(out + (N - k) * STRIDE, left_re * s - left_im * c, right_re * s - right_im * c);
  }
}

static void columns_backward(const float *in, float *depth) {
  static pair z[N];
  const float scale = 1.0f / N;
  z[place[0]] = (pair){*(const loose *)in * scale, *(const loose *)(in + W) * scale};
  for (int k = 1; k <= N / 2; k++) {
    const float *low = in + k * STRIDE, *high = in + (N - k) * STRIDE;
    vector left = *(const loose *)low, right = *(const loose *)(low + W);
    vector left_high = *(const loose *)high, right_high = *(const loose *)(high + W);
    float c = scale * phase[k][0], s = scale * phase[k][1];
    vector left_re = left * c + left_high * s, left_im = left * s - left_high * c;
    vector right_re = right * c + right_high * s, right_im = right * s - right_high * c;
    z[place[k]] = (pair){left_re - right_im, left_im + right_re};
    if (k < N / 2) z[place[N - k]] = (pair){left_re + right_im, right_re - left_im};
  }
  int length = SHORTEST;
  if (length == 2) stage_2(z);
  else stage(z, length, 1);
  for (length *= 4; length < N; length *= 4) stage(z, length, 1);
  for (int j = 0; j < N / 4; j++) {
    pair a[4];
    for (int i = 0; i < 4; i++) a[i] = z[j + i * (N / 4)];
    backward_4(a, turn[j]);
    for (int i = 0; i < 4; i++) {
      int n = j + i * (N / 4);
      if (i < 2) put(depth + 2 * n * N, a[i].re, a[i].im);
      else put(depth + (2 * (N - 1 - n) + 1) * N, -a[i].re, -a[i].im);
    }
  }
}

// Thomas's algorithm along the rows.

#define LOW(i, d) ((i) & (d) ? W + (i) - (d) : (i))
#define HIGH(i, d) ((i) & (d) ? W + (i) : (i) + (d))
#define EXCHANGE(d) \
  _Pragma("GCC unroll 16") for (int i = 0; i < W; i++) if (!(i & (d))) { \
    vector a = t[i], b = t[i + (d)]; \
    t[i] = __builtin_shufflevector(a, b, LIST(LOW, d)); \
    t[i + (d)] = __builtin_shufflevector(a, b, LIST(HIGH, d)); \
  }

ALWAYS void transpose(vector t[W]) {
  EXCHANGE(1)
  EXCHANGE(2)
#if W > 4
  EXCHANGE(4)
#endif
#if W > 8
  EXCHANGE(8)
#endif
}

static void along_rows(void) {
  static vector d[N];
  for (int block = 0; block < N / W; block++) {
    const vector *c = coefficient[block];
    float *rows = modes[block * W];
    vector state = {0};
    for (int j = 0; j < N; j += W) {
      vector t[W];
      _Pragma("GCC unroll 16") for (int i = 0; i < W; i++) t[i] = *(const vector *)(rows + i * STRIDE + j);
      transpose(t);
      _Pragma("GCC unroll 16") for (int i = 0; i < W; i++) {
        state = c[j + i] * t[i] - c[j + i] * state;
        d[j + i] = state;
      }
    }
    state = (vector){0};
    for (int j = N - W; j >= 0; j -= W) {
      vector t[W];
      _Pragma("GCC unroll 16") for (int i = W - 1; i >= 0; i--) {
        state = d[j + i] - c[j + i] * state;
        t[i] = state;
      }
      transpose(t);
      _Pragma("GCC unroll 16") for (int i = 0; i < W; i++) *(vector *)(rows + i * STRIDE + j) = t[i];
    }
  }
}

void solve(const void *divergence, float *depth) {
  const float *f = divergence;
  for (int column = 0; column < N; column += 2 * W) columns_forward(f + column, modes[0] + column);
  along_rows();
  for (int column = 0; column < N; column += 2 * W) columns_backward(modes[0] + column, depth + column);
}

// From the pixels on: slopes by the upper four bits of red, green and blue, and their divergence.

typedef struct {
  float x, y;
} slope;
static slope table[4096];  // by {blue, green, red}

void load(const float *slopes) {  // (16, 16, 16, 2) by red, green and blue
  for (int i = 0; i < 4096; i++) {
    int at = (i & 0xf) << 8 | (i & 0xf0) | i >> 8;
    table[i] = (slope){slopes[2 * at], slopes[2 * at + 1]};
  }
}

// The upper halves of eight bytes, side by side.
ALWAYS uint64_t upper_halves(const uint8_t *bytes) {
  uint64_t word;
  memcpy(&word, bytes, sizeof word);
#ifdef __BMI2__
  return __builtin_ia32_pext_di(word, 0xf0f0f0f0f0f0f0f0);
#else
  word = word >> 4 & 0x0f0f0f0f0f0f0f0f;
  word = (word | word >> 4) & 0x00ff00ff00ff00ff;
  word = (word | word >> 8) & 0x0000ffff0000ffff;
  return (word | word >> 16) & 0xffffffff;
#endif
}

void solve_pixels(const void *pixels, float *depth) {
  static float f[N * N] __attribute__((aligned(64)));
  static slope rows[2][N + 1];  // of this row and the one above, with a zero before the first
  const uint8_t *rgb = pixels;
  memset(rows, 0, sizeof rows);
  for (int row = 0; row < N; row++) {
    slope *here = rows[row % 2] + 1, *above = rows[1 - row % 2] + 1;
    for (int i = 0; i < N; i += 8, rgb += 24) {
      uint64_t a = upper_halves(rgb), b = upper_halves(rgb + 8), c = upper_halves(rgb + 16);
      uint64_t low = a | b << 32, high = b >> 16 | c << 16;  // of pixels 0 to 3 and 4 to 7
      _Pragma("GCC unroll 4") for (int j = 0; j < 4; j++) {
        here[i + j] = table[low >> 12 * j & 0xfff];
        here[i + j + 4] = table[high >> 12 * j & 0xfff];
      }
    }
    for (int i = 0; i < N; i++) f[row * N + i] = here[i].x - here[i - 1].x + here[i].y - above[i].y;
  }
  solve(f, depth);
}

// Solve `runs` frames, `count` of them in turn, and write down the nanoseconds of each.
void time_solves(
    void (*solve)(const void *, float *), const void *const *frames, int count, float *depth, int runs,
    int64_t *nanoseconds) {
  for (int run = 0; run < runs; run++) {
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    solve(frames[run % count], depth);
    clock_gettime(CLOCK_MONOTONIC, &end);
    nanoseconds[run] = (end.tv_sec - begin.tv_sec) * INT64_C(1000000000) + end.tv_nsec - begin.tv_nsec;
  }
}
