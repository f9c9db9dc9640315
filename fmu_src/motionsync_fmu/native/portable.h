/* What the C of an instance asks of a compiler, and what keeps several instances in one program apart. */
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

/* --- names: FMI's functions get a prefix where several instances are linked into one program; the others get it too
 * --- */

#if defined FMI2_FUNCTION_PREFIX
#define INSTANCE_PREFIX FMI2_FUNCTION_PREFIX
#elif defined FMI3_FUNCTION_PREFIX
#define INSTANCE_PREFIX FMI3_FUNCTION_PREFIX
#endif

#ifdef INSTANCE_PREFIX
#define JOINED(prefix, name) prefix##name
#define OWN(prefix, name) JOINED(prefix, name)
#define block_initialize OWN(INSTANCE_PREFIX, block_initialize)
#define block_start OWN(INSTANCE_PREFIX, block_start)
#define block_step OWN(INSTANCE_PREFIX, block_step)
#define system_memory OWN(INSTANCE_PREFIX, system_memory)
#define instance_check_mode OWN(INSTANCE_PREFIX, instance_check_mode)
#define instance_check_pointer OWN(INSTANCE_PREFIX, instance_check_pointer)
#define instance_count_out_of_range OWN(INSTANCE_PREFIX, instance_count_out_of_range)
#define instance_deserialize OWN(INSTANCE_PREFIX, instance_deserialize)
#define instance_enter_initialization OWN(INSTANCE_PREFIX, instance_enter_initialization)
#define instance_exit_initialization OWN(INSTANCE_PREFIX, instance_exit_initialization)
#define instance_free OWN(INSTANCE_PREFIX, instance_free)
#define instance_free_state OWN(INSTANCE_PREFIX, instance_free_state)
#define instance_get_booleans OWN(INSTANCE_PREFIX, instance_get_booleans)
#define instance_get_enumerations OWN(INSTANCE_PREFIX, instance_get_enumerations)
#define instance_get_flags OWN(INSTANCE_PREFIX, instance_get_flags)
#define instance_get_integers OWN(INSTANCE_PREFIX, instance_get_integers)
#define instance_get_output_derivatives OWN(INSTANCE_PREFIX, instance_get_output_derivatives)
#define instance_get_reals OWN(INSTANCE_PREFIX, instance_get_reals)
#define instance_guid OWN(INSTANCE_PREFIX, instance_guid)
#define instance_importer_data OWN(INSTANCE_PREFIX, instance_importer_data)
#define instance_memory OWN(INSTANCE_PREFIX, instance_memory)
#define instance_mode OWN(INSTANCE_PREFIX, instance_mode)
#define instance_new OWN(INSTANCE_PREFIX, instance_new)
#define instance_report OWN(INSTANCE_PREFIX, instance_report)
#define instance_reset OWN(INSTANCE_PREFIX, instance_reset)
#define instance_restore OWN(INSTANCE_PREFIX, instance_restore)
#define instance_save OWN(INSTANCE_PREFIX, instance_save)
#define instance_serialize OWN(INSTANCE_PREFIX, instance_serialize)
#define instance_serialized_size OWN(INSTANCE_PREFIX, instance_serialized_size)
#define instance_set_booleans OWN(INSTANCE_PREFIX, instance_set_booleans)
#define instance_set_categories OWN(INSTANCE_PREFIX, instance_set_categories)
#define instance_set_enumerations OWN(INSTANCE_PREFIX, instance_set_enumerations)
#define instance_set_flags OWN(INSTANCE_PREFIX, instance_set_flags)
#define instance_set_input_derivatives OWN(INSTANCE_PREFIX, instance_set_input_derivatives)
#define instance_set_integers OWN(INSTANCE_PREFIX, instance_set_integers)
#define instance_set_reals OWN(INSTANCE_PREFIX, instance_set_reals)
#define instance_set_times OWN(INSTANCE_PREFIX, instance_set_times)
#define instance_step OWN(INSTANCE_PREFIX, instance_step)
#define instance_terminate OWN(INSTANCE_PREFIX, instance_terminate)
#define instance_time OWN(INSTANCE_PREFIX, instance_time)
#endif

#endif
