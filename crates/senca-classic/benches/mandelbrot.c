/* The Mandelbrot loop, vectorized by hand: what the quick loop of the laboratory exercise is measured
 * against. Built and run by mandelbrot.rs:
 *
 *   cc -O3 -march=native -ffp-contract=off -pthread mandelbrot.c -o mandelbrot
 *   ./mandelbrot SIZE M THREADS REPEATS
 *
 * Prints the shortest time in seconds and the sum of all counts. With -DFUSED it uses fused operations,
 * which round differently; with -DNARROW it uses AVX2 where AVX-512 would be there.
 */
#define _GNU_SOURCE
#include <immintrin.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double UMIN = -1.5, UMAX = 0.5, VMIN = -1.0, VMAX = 1.0, EPS = 100.0;

static int size, m;
static uint32_t *counts;
static atomic_int next_row;

#if defined(__AVX512F__) && !defined(NARROW)

#define LANES 8
typedef __m512d vec;
#define SPLAT(a) _mm512_set1_pd(a)
#define LOAD(p) _mm512_loadu_pd(p)
#define ADD(a, b) _mm512_add_pd(a, b)
#define SUB(a, b) _mm512_sub_pd(a, b)
#define MUL(a, b) _mm512_mul_pd(a, b)
#define FMA(a, b, c) _mm512_fmadd_pd(a, b, c)
#define FMS(a, b, c) _mm512_fmsub_pd(a, b, c)
typedef __mmask8 mask;
#define ALL 0xff
#define WITHIN(in, s, limit) _mm512_mask_cmp_pd_mask(in, s, limit, _CMP_LT_OQ)
#define COUNT(k, in) _mm512_mask_add_pd(k, in, k, SPLAT(1.0))
#define NONE(in) ((in) == 0)
#define EITHER(a, b) ((a) | (b))
#define STORE(p, k) _mm256_storeu_si256((__m256i *)(p), _mm512_cvtpd_epi32(k))

#else

#define LANES 4
typedef __m256d vec;
#define SPLAT(a) _mm256_set1_pd(a)
#define LOAD(p) _mm256_loadu_pd(p)
#define ADD(a, b) _mm256_add_pd(a, b)
#define SUB(a, b) _mm256_sub_pd(a, b)
#define MUL(a, b) _mm256_mul_pd(a, b)
#define FMA(a, b, c) _mm256_fmadd_pd(a, b, c)
#define FMS(a, b, c) _mm256_fmsub_pd(a, b, c)
typedef __m256d mask;
#define ALL _mm256_castsi256_pd(_mm256_set1_epi64x(-1))
#define WITHIN(in, s, limit) _mm256_and_pd(in, _mm256_cmp_pd(s, limit, _CMP_LT_OQ))
#define COUNT(k, in) _mm256_add_pd(k, _mm256_and_pd(in, SPLAT(1.0)))
#define NONE(in) (_mm256_movemask_pd(in) == 0)
#define EITHER(a, b) _mm256_or_pd(a, b)
#define STORE(p, k) _mm_storeu_si128((__m128i *)(p), _mm256_cvtpd_epi32(k))

#endif

#ifdef FUSED
#define STEP(x, y, cx, in, k)                                                                      \
    do {                                                                                           \
        vec xx = FMA(x, x, cx), xy = ADD(x, x);                                                    \
        x = SUB(xx, MUL(y, y)), y = FMA(xy, y, cy);                                                \
        in = WITHIN(in, FMA(x, x, MUL(y, y)), limit);                                              \
        k = COUNT(k, in);                                                                          \
    } while (0)
#else
#define STEP(x, y, cx, in, k)                                                                      \
    do {                                                                                           \
        vec xy = MUL(x, y);                                                                        \
        x = ADD(SUB(MUL(x, x), MUL(y, y)), cx), y = ADD(ADD(xy, xy), cy);                          \
        in = WITHIN(in, ADD(MUL(x, x), MUL(y, y)), limit);                                         \
        k = COUNT(k, in);                                                                          \
    } while (0)
#endif

/* Two vectors together, so that each fills the waiting times of the other. */
static void row(int r, const double *u)
{
    const vec limit = SPLAT(EPS * EPS), cy = SPLAT((VMAX - VMIN) / size * r + VMIN);
    for (int i = 0; i < size; i += 2 * LANES) {
        const vec c0 = LOAD(u + i), c1 = LOAD(u + i + LANES);
        vec x0 = SPLAT(0.0), y0 = x0, x1 = x0, y1 = x0, k0 = x0, k1 = x0;
        mask in0 = ALL, in1 = ALL;
        int n = 0;
        for (; n + 4 <= m; n += 4) {
            for (int j = 0; j < 4; j++) {
                STEP(x0, y0, c0, in0, k0);
                STEP(x1, y1, c1, in1, k1);
            }
            if (NONE(EITHER(in0, in1)))
                break;
        }
        for (int j = 0; j < m % 4; j++) {
            STEP(x0, y0, c0, in0, k0);
            STEP(x1, y1, c1, in1, k1);
        }
        STORE(counts + (size_t)r * size + i, k0);
        STORE(counts + (size_t)r * size + i + LANES, k1);
    }
}

static void *work(void *u)
{
    int r;
    while ((r = atomic_fetch_add(&next_row, 1)) < size)
        row(r, u);
    return NULL;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 5 || (size = atoi(argv[1])) <= 0 || size % (2 * LANES) != 0 || (m = atoi(argv[2])) < 0)
        return fprintf(stderr, "usage: mandelbrot SIZE M THREADS REPEATS; SIZE divides by 16\n"), 2;
    int threads = atoi(argv[3]), repeats = atoi(argv[4]);
    double *u = malloc(sizeof *u * size);
    pthread_t *thread = malloc(sizeof *thread * (threads + 1));
    counts = malloc(sizeof *counts * size * size);
    if (!u || !thread || !counts || threads < 1)
        return 1;
    for (int x = 0; x < size; x++)
        u[x] = (UMAX - UMIN) / size * x + UMIN;
    double best = 1e9;
    for (int repeat = 0; repeat < repeats; repeat++) {
        double start = now();
        atomic_store(&next_row, 0);
        for (int t = 1; t < threads; t++)
            pthread_create(&thread[t], NULL, work, u);
        work(u);
        for (int t = 1; t < threads; t++)
            pthread_join(thread[t], NULL);
        double took = now() - start;
        if (took < best)
            best = took;
    }
    uint64_t sum = 0;
    for (size_t i = 0; i < (size_t)size * size; i++)
        sum += counts[i];
    printf("%.6f %llu\n", best, (unsigned long long)sum);
    return 0;
}
