/* What the C of a unit asks of a compiler, and what keeps several units in one program apart. */
#ifndef PORTABLE_H
#define PORTABLE_H

#include <float.h>

/* --- arithmetic: the same bits everywhere need doubles of IEEE 754, and a compiler that does not reorder --- */

#if defined __FAST_MATH__ || defined _M_FP_FAST || (defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__)
#error "-ffast-math is not allowed: the results would depend on the compiler"
#elif defined __ASSOCIATIVE_MATH__ || defined __RECIPROCAL_MATH__ || defined __NO_SIGNED_ZEROS__
#error "options that let a compiler reorder or replace arithmetic are not allowed"
#elif FLT_RADIX != 2 || DBL_MANT_DIG != 53 || DBL_MIN_EXP != -1021 || DBL_MAX_EXP != 1024
#error "double has to be the 64-bit double of IEEE 754"
#elif defined FLT_EVAL_METHOD && FLT_EVAL_METHOD != 0
#error "doubles have to be computed as doubles: on x86 with 32 bits, -msse2 -mfpmath=sse"
#endif

/* Refuses to compile unless a condition holds. C99 has no assertion for this. */
#define MUST_HOLD(name, condition) typedef char name[(condition) ? 1 : -1]

/* --- names: FMI's functions get a prefix where several units are linked into one program; the others get it too --- */

#if defined FMI2_FUNCTION_PREFIX
#define UNIT_PREFIX FMI2_FUNCTION_PREFIX
#elif defined FMI3_FUNCTION_PREFIX
#define UNIT_PREFIX FMI3_FUNCTION_PREFIX
#endif

#ifdef UNIT_PREFIX
#define JOINED(prefix, name) prefix##name
#define OWN(prefix, name) JOINED(prefix, name)
#define block_initialize OWN(UNIT_PREFIX, block_initialize)
#define block_start OWN(UNIT_PREFIX, block_start)
#define block_step OWN(UNIT_PREFIX, block_step)
#define system_memory OWN(UNIT_PREFIX, system_memory)
#define unit_check_mode OWN(UNIT_PREFIX, unit_check_mode)
#define unit_check_pointer OWN(UNIT_PREFIX, unit_check_pointer)
#define unit_count_out_of_range OWN(UNIT_PREFIX, unit_count_out_of_range)
#define unit_deserialize OWN(UNIT_PREFIX, unit_deserialize)
#define unit_enter_initialization OWN(UNIT_PREFIX, unit_enter_initialization)
#define unit_exit_initialization OWN(UNIT_PREFIX, unit_exit_initialization)
#define unit_free OWN(UNIT_PREFIX, unit_free)
#define unit_free_state OWN(UNIT_PREFIX, unit_free_state)
#define unit_get_booleans OWN(UNIT_PREFIX, unit_get_booleans)
#define unit_get_enumerations OWN(UNIT_PREFIX, unit_get_enumerations)
#define unit_get_flags OWN(UNIT_PREFIX, unit_get_flags)
#define unit_get_integers OWN(UNIT_PREFIX, unit_get_integers)
#define unit_get_output_derivatives OWN(UNIT_PREFIX, unit_get_output_derivatives)
#define unit_get_reals OWN(UNIT_PREFIX, unit_get_reals)
#define unit_guid OWN(UNIT_PREFIX, unit_guid)
#define unit_importer_data OWN(UNIT_PREFIX, unit_importer_data)
#define unit_memory OWN(UNIT_PREFIX, unit_memory)
#define unit_mode OWN(UNIT_PREFIX, unit_mode)
#define unit_new OWN(UNIT_PREFIX, unit_new)
#define unit_report OWN(UNIT_PREFIX, unit_report)
#define unit_reset OWN(UNIT_PREFIX, unit_reset)
#define unit_restore OWN(UNIT_PREFIX, unit_restore)
#define unit_save OWN(UNIT_PREFIX, unit_save)
#define unit_serialize OWN(UNIT_PREFIX, unit_serialize)
#define unit_serialized_size OWN(UNIT_PREFIX, unit_serialized_size)
#define unit_set_booleans OWN(UNIT_PREFIX, unit_set_booleans)
#define unit_set_categories OWN(UNIT_PREFIX, unit_set_categories)
#define unit_set_enumerations OWN(UNIT_PREFIX, unit_set_enumerations)
#define unit_set_flags OWN(UNIT_PREFIX, unit_set_flags)
#define unit_set_input_derivatives OWN(UNIT_PREFIX, unit_set_input_derivatives)
#define unit_set_integers OWN(UNIT_PREFIX, unit_set_integers)
#define unit_set_reals OWN(UNIT_PREFIX, unit_set_reals)
#define unit_set_times OWN(UNIT_PREFIX, unit_set_times)
#define unit_step OWN(UNIT_PREFIX, unit_step)
#define unit_terminate OWN(UNIT_PREFIX, unit_terminate)
#define unit_time OWN(UNIT_PREFIX, unit_time)
#endif

#endif
