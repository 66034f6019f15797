// Which of two looks at hanging cloth counts. What was once matched a stripe too far, or slid along stripes, is carried
// on, and matched there again. So cloth is matched anew from where its simulation alone has it: where that explains the
// picture about as well, although no earlier frame has fitted it, each match counts that is the better one.
#include "match/layout.h"

// anew, matches [LC_MATCH*n], as match_patches left them; a vertex may be seen from one start and hidden from the
// other. The weights of those anew must sum to at least `share` of the others'. sums: one for each work-item. In one
// work-group, of a power of two.
kernel void match_anew(int n, float share, global const float* restrict anew, global float* restrict matches,
                       local float2* sums) {
  const int me = get_local_id(0), size = get_local_size(0);
  float2 mine = 0.0f;
  for (int i = me; i < n; i += size)
    mine += (float2)(matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX], anew[LC_MATCH * i + LC_MATCH_WEIGHT_PX]);
  sums[me] = mine;
  for (int half_size = size / 2; half_size > 0; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (me < half_size) sums[me] += sums[me + half_size];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const float2 all = sums[0];
  if (!(all.y >= share * all.x)) return;
  for (int i = me; i < n; i += size) {
    const float8 other = vload8(i, anew), match = vload8(i, matches);
    const int better = match.s5 > 0.0f ? other.s6 > match.s6 : 1;
    if (other.s5 > 0.0f && better) vstore8(other, i, matches);
  }
}
