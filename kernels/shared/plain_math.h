// floor, rint, fmin and fmax of numbers (not NaN), as one instruction or two: PoCL 3.1's are functions that look at
// every case, lane by lane.
#ifndef LC_SHARED_PLAIN_MATH_H
#define LC_SHARED_PLAIN_MATH_H

#define LC_LESSER(a, b) ((a) < (b) ? (a) : (b))
#define LC_GREATER(a, b) ((a) > (b) ? (a) : (b))

#ifdef __has_builtin
#if LC_CPU && __has_builtin(__builtin_elementwise_floor) && __has_builtin(__builtin_elementwise_roundeven)
#define LC_FLOOR(x) __builtin_elementwise_floor(x)
#define LC_RINT(x) __builtin_elementwise_roundeven(x)
#endif
#endif
#ifndef LC_FLOOR
#define LC_FLOOR(x) floor(x)
#define LC_RINT(x) rint(x)
#endif

#endif
