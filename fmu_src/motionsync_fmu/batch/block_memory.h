/* What all C of this folder shares: the two functions of block.c, and how memory is reached by its address. */
#ifndef BLOCK_MEMORY_H
#define BLOCK_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

/* Both functions return the refusal, and set `failed` where Python would raise. */
typedef struct Block Block;
int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed);

#define AT(Type, address) (*(Type *)(intptr_t)(address))
#define TABLE(Row) struct { const Row *rows; int64_t count; } /* Table in reductions.py */

#endif
