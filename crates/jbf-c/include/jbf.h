/* jbf: friction laws and effects, one fixed step at a time. C interface of the Rust crate jbf-core.
 *
 *   jbf_journal_f32 model;
 *   jbf_journal_f32_state state;
 *   jbf_error error;
 *   if (jbf_journal_f32_init(&model, &bearing, 104.0, parameters, 4, JBF_CLOCK_JOURNAL, &error)) ...
 *   jbf_journal_f32_effect(&model, "sensor_lag", &tau_s, 1, &error);
 *   jbf_journal_f32_start(&model, &state, &motion);
 *   every 2 ms: friction_n = jbf_journal_f32_step(&model, &state, &motion, 0.002f);
 *
 * `jbf export MODEL --c model.h` writes the first part for a fitted model.
 *
 * Units are SI and in the names. Models and states lie where you put them; nothing is allocated, no
 * function blocks, a step cannot fail: what is not finite changes nothing. One model serves many
 * states; a state is stepped by one thread at a time. The same input gives the same bits as jbf-core
 * in Rust, on every target. A model must be built by `init` before anything else sees it. The static
 * library keeps of each law only what you call.
 *
 * Licensed under MIT or Apache-2.0, as you like.
 */
#ifndef JBF_H
#define JBF_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JBF_OK 0
#define JBF_NULL (-1)      /* a pointer is null */
#define JBF_PARAMETER (-2) /* a parameter breaks its rule: see jbf_error */
#define JBF_NAME (-3)      /* no such effect or clock, or the effect does not go with the law */

#define JBF_CLOCK_JOURNAL 0 /* tbar = t U_tr/R */
#define JBF_CLOCK_THESIS 1  /* tbar = t/1 s */

/* A bearing and its lubricant. */
typedef struct {
  double radius_m;
  double length_m;
  double clearance_m;
  double mass_kg;
  double viscosity_pa_s;
  uint32_t count; /* bearings on the shaft */
} jbf_bearing;

/* Imposed motion at one instant.
 *
 * angle_rad          on a linear axis the position, m
 * temperature_c      NAN if it is not measured; effects of temperature then act as at their reference
 * weight_offset_rad  angle over which a weight acts minus angle_rad; zero, except for a joint behind
 *                    other moving joints, whose link turns with all of them
 */
typedef struct {
  float time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n, temperature_c, weight_offset_rad;
} jbf_motion_f32;

typedef struct {
  double time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n, temperature_c,
      weight_offset_rad;
} jbf_motion_f64;

/* A whole run: columns of `samples` values; temperature_c and weight_offset_rad may be NULL. A motion
 * that starts or stops between two samples requires an additional sample at that instant. */
typedef struct {
  size_t samples;
  const double *time_s, *velocity_m_s, *acceleration_m_s2, *angle_rad, *load_n, *temperature_c,
      *weight_offset_rad;
} jbf_record;

/* Which parameter, which rule, which value; texts end with a zero. */
typedef struct {
  char name[32];
  char rule[96];
  double value;
} jbf_error;

/* For each law (`jbf effects --law NAME`) and kind of number:
 *
 * init     build the law from its parameters, in the order of its page; bearing may be NULL for a law
 *          in newtons, error may always be
 * effect   add an effect by its name, with its parameters in the order of its page
 * start    the state at the first sample; gives the reading there, N
 * step     advance to a motion dt_s later; gives the reading there, N
 * predict  readings (N) along a record; `jbf predict` uses max_step_s = 0.02 and the record that
 *          `jbf.export.record` returns
 */
#define JBF_DECLARE(law, kind, real, model_words, state_words)                                      \
  typedef struct {                                                                                 \
    uint64_t words[model_words];                                                                   \
  } jbf_##law##_##kind;                                                                            \
  typedef struct {                                                                                 \
    uint64_t words[state_words];                                                                   \
  } jbf_##law##_##kind##_state;                                                                    \
  int32_t jbf_##law##_##kind##_init(jbf_##law##_##kind *model, const jbf_bearing *bearing,         \
                                    double load_n, const double *parameters, size_t count,         \
                                    int32_t clock, jbf_error *error);                              \
  int32_t jbf_##law##_##kind##_effect(jbf_##law##_##kind *model, const char *name,                 \
                                      const double *parameters, size_t count, jbf_error *error);   \
  real jbf_##law##_##kind##_start(const jbf_##law##_##kind *model,                                 \
                                  jbf_##law##_##kind##_state *state,                               \
                                  const jbf_motion_##kind *motion);                                \
  real jbf_##law##_##kind##_step(const jbf_##law##_##kind *model,                                  \
                                 jbf_##law##_##kind##_state *state,                                \
                                 const jbf_motion_##kind *motion, real dt_s);                      \
  int32_t jbf_##law##_##kind##_predict(const jbf_##law##_##kind *model, const jbf_record *record,  \
                                       double max_step_s, real *out_n);

JBF_DECLARE(journal, f32, float, 96, 128)
JBF_DECLARE(journal, f64, double, 192, 256)
JBF_DECLARE(journal_full, f32, float, 96, 128)
JBF_DECLARE(journal_full, f64, double, 192, 256)
JBF_DECLARE(coulomb, f32, float, 96, 128)
JBF_DECLARE(coulomb, f64, double, 192, 256)
JBF_DECLARE(stribeck, f32, float, 96, 128)
JBF_DECLARE(stribeck, f64, double, 192, 256)
JBF_DECLARE(seven_parameter, f32, float, 96, 192)
JBF_DECLARE(seven_parameter, f64, double, 192, 384)
JBF_DECLARE(dahl, f32, float, 96, 128)
JBF_DECLARE(dahl, f64, double, 192, 256)
JBF_DECLARE(lugre, f32, float, 96, 128)
JBF_DECLARE(lugre, f64, double, 192, 256)
JBF_DECLARE(maxwell_slip, f32, float, 96, 128)
JBF_DECLARE(maxwell_slip, f64, double, 192, 256)
JBF_DECLARE(elasto_plastic, f32, float, 96, 128)
JBF_DECLARE(elasto_plastic, f64, double, 192, 256)
JBF_DECLARE(rate_and_state, f32, float, 96, 128)
JBF_DECLARE(rate_and_state, f64, double, 192, 256)

#ifdef __cplusplus
}
#endif

#endif
