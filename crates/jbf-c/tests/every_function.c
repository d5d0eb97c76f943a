/* Every function of jbf.h for every law in both kinds of number, refused, started, stepped and
 * predicted, for a compiler's sanitizers to watch: `make sanitize`. Models and states lie on the heap,
 * exactly as large as the header says, so that a word beyond them is seen. */
#include "jbf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 32

static const jbf_bearing BEARING = {0.0127, 0.0254, 2.5e-5, 1.0, 0.02, 4};
static unsigned long done;

#define MUST(held)                                                                                 \
  do {                                                                                             \
    done++;                                                                                        \
    if (!(held)) {                                                                                 \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #held);                                   \
      exit(1);                                                                                     \
    }                                                                                              \
  } while (0)

static const double JOURNAL[] = {0.26, 0.06, 7.5e5, 33.0};
static const double COULOMB[] = {8.0, 10.0, 5.0};
static const double STRIBECK[] = {8.0, 10.0, 0.05, 2.0, 5.0};
static const double SEVEN[] = {1e5, 8.0, 5.0, 2.0, 0.05, 0.01, 1.0};
static const double DAHL[] = {8.0, 1e6, 1.0, 5.0};
static const double LUGRE[] = {8.0, 10.0, 0.05, 1e5, 100.0, 0.05, 5.0};
static const double MAXWELL[] = {8.0, 1e6, 1.0, 5.0};
static const double ELASTO[] = {8.0, 1e6, 0.5, 5.0};
static const double RATE[] = {8.0, 0.1, 0.2, 1e-5, 0.01, 5.0};

#define COUNT(values) (sizeof(values) / sizeof((values)[0]))

#define TRY(law, kind, real, given)                                                                \
  static void try_##law##_##kind(void) {                                                           \
    const size_t count = COUNT(given);                                                             \
    double *values = malloc(sizeof given);                                                         \
    jbf_##law##_##kind *model = malloc(sizeof *model);                                             \
    jbf_##law##_##kind##_state *state = malloc(sizeof *state);                                     \
    jbf_error *error = malloc(sizeof *error);                                                      \
    MUST(values && model && state && error);                                                       \
    memcpy(values, given, sizeof given);                                                           \
    /* What is refused. */                                                                         \
    MUST(jbf_##law##_##kind##_init(NULL, &BEARING, 104.0, values, count, 0, error) == JBF_NULL);   \
    MUST(jbf_##law##_##kind##_init(model, &BEARING, 104.0, values, count, 7, error) == JBF_NAME);  \
    MUST(jbf_##law##_##kind##_init(model, &BEARING, 104.0, NULL, 0, 0, error) == JBF_PARAMETER);   \
    MUST(strlen(error->name) > 0 && strlen(error->rule) > 0);                                      \
    MUST(jbf_##law##_##kind##_init(model, &BEARING, 104.0, values, count - 1, 0, NULL) ==          \
         JBF_PARAMETER);                                                                           \
    MUST(jbf_##law##_##kind##_init(model, &BEARING, 104.0, values, count, 0, error) == JBF_OK);    \
    const double lag_s = 0.01, delay_s = 0.02, bad = -1.0;                                         \
    MUST(jbf_##law##_##kind##_effect(NULL, "sensor_lag", &lag_s, 1, error) == JBF_NULL);           \
    MUST(jbf_##law##_##kind##_effect(model, NULL, &lag_s, 1, error) == JBF_NULL);                  \
    MUST(jbf_##law##_##kind##_effect(model, "none such", &lag_s, 1, error) == JBF_NAME);           \
    MUST(jbf_##law##_##kind##_effect(model, "\xff\xfe", &lag_s, 1, error) == JBF_NAME);            \
    MUST(jbf_##law##_##kind##_effect(model, "sensor_lag", &bad, 1, error) == JBF_PARAMETER);       \
    MUST(jbf_##law##_##kind##_effect(model, "sensor_lag", NULL, 0, NULL) == JBF_PARAMETER);        \
    MUST(jbf_##law##_##kind##_effect(model, "sensor_lag", &lag_s, 1, error) == JBF_OK);            \
    MUST(jbf_##law##_##kind##_effect(model, "time_delay", &delay_s, 1, NULL) == JBF_OK);           \
    /* A run, and steps that are none. */                                                          \
    jbf_motion_##kind motion = {0, 0, 0, 0, 104, NAN, 0};                                          \
    MUST(jbf_##law##_##kind##_start(NULL, state, &motion) == 0);                                   \
    MUST(jbf_##law##_##kind##_start(model, NULL, &motion) == 0);                                   \
    MUST(jbf_##law##_##kind##_start(model, state, NULL) == 0);                                     \
    MUST(isfinite(jbf_##law##_##kind##_start(model, state, &motion)));                             \
    for (int i = 1; i < 1000; i++) {                                                               \
      motion.time_s = (real)(0.002 * i);                                                           \
      motion.velocity_m_s = (real)(0.05 * sin(0.02 * i));                                          \
      motion.angle_rad += (real)0.002 * motion.velocity_m_s / (real)0.0127;                        \
      motion.temperature_c = i % 2 ? (real)40 : (real)NAN;                                         \
      motion.weight_offset_rad = (real)(0.01 * i);                                                 \
      MUST(isfinite(jbf_##law##_##kind##_step(model, state, &motion, (real)0.002)));               \
    }                                                                                              \
    MUST(jbf_##law##_##kind##_step(NULL, state, &motion, 1) == 0);                                 \
    MUST(jbf_##law##_##kind##_step(model, NULL, &motion, 1) == 0);                                 \
    MUST(jbf_##law##_##kind##_step(model, state, NULL, 1) == 0);                                   \
    motion.velocity_m_s = (real)INFINITY;                                                          \
    MUST(isfinite(jbf_##law##_##kind##_step(model, state, &motion, (real)0.002)));                 \
    /* A record. */                                                                                \
    double *columns = malloc(7 * SAMPLES * sizeof *columns);                                       \
    real *out = malloc(SAMPLES * sizeof *out);                                                     \
    MUST(columns && out);                                                                          \
    for (int i = 0; i < SAMPLES; i++) {                                                            \
      columns[i] = 0.01 * i;                                                                       \
      columns[SAMPLES + i] = 0.05 * sin(0.3 * i);                                                  \
      columns[2 * SAMPLES + i] = 0;                                                                \
      columns[3 * SAMPLES + i] = 0.1 * i;                                                          \
      columns[4 * SAMPLES + i] = 104;                                                              \
      columns[5 * SAMPLES + i] = 40;                                                               \
      columns[6 * SAMPLES + i] = 0.2 * i;                                                          \
    }                                                                                              \
    jbf_record record = {SAMPLES,                                                                  \
                         columns,                                                                  \
                         columns + SAMPLES,                                                        \
                         columns + 2 * SAMPLES,                                                    \
                         columns + 3 * SAMPLES,                                                    \
                         columns + 4 * SAMPLES,                                                    \
                         columns + 5 * SAMPLES,                                                    \
                         columns + 6 * SAMPLES};                                                   \
    MUST(jbf_##law##_##kind##_predict(NULL, &record, 0.02, out) == JBF_NULL);                      \
    MUST(jbf_##law##_##kind##_predict(model, NULL, 0.02, out) == JBF_NULL);                        \
    MUST(jbf_##law##_##kind##_predict(model, &record, 0.02, NULL) == JBF_NULL);                    \
    MUST(jbf_##law##_##kind##_predict(model, &record, 0.02, out) == JBF_OK);                       \
    for (int i = 0; i < SAMPLES; i++)                                                              \
      MUST(isfinite(out[i]));                                                                      \
    record.temperature_c = NULL;                                                                   \
    record.weight_offset_rad = NULL;                                                               \
    MUST(jbf_##law##_##kind##_predict(model, &record, 0.02, out) == JBF_OK);                       \
    record.load_n = NULL;                                                                          \
    MUST(jbf_##law##_##kind##_predict(model, &record, 0.02, out) == JBF_NULL);                     \
    free(out);                                                                                     \
    free(columns);                                                                                 \
    free(error);                                                                                   \
    free(state);                                                                                   \
    free(model);                                                                                   \
    free(values);                                                                                  \
  }

#define BOTH(law, given) TRY(law, f32, float, given) TRY(law, f64, double, given)

BOTH(journal, JOURNAL)
BOTH(journal_full, JOURNAL)
BOTH(coulomb, COULOMB)
BOTH(stribeck, STRIBECK)
BOTH(seven_parameter, SEVEN)
BOTH(dahl, DAHL)
BOTH(lugre, LUGRE)
BOTH(maxwell_slip, MAXWELL)
BOTH(elasto_plastic, ELASTO)
BOTH(rate_and_state, RATE)

#define RUN(law) (try_##law##_f32(), try_##law##_f64())

int main(void) {
  RUN(journal);
  RUN(journal_full);
  RUN(coulomb);
  RUN(stribeck);
  RUN(seven_parameter);
  RUN(dahl);
  RUN(lugre);
  RUN(maxwell_slip);
  RUN(elasto_plastic);
  RUN(rate_and_state);
  printf("%lu checks of every function of jbf.h, none found fault with\n", done);
  return 0;
}
