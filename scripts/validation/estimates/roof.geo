// SPDX-License-Identifier: Apache-2.0
// The roof of a channel, 3 m by 0.2 m; n cells per meter of the channel.
DefineConstant[ n = 4 ];
Point(1) = {0, 1, 0}; Point(2) = {3, 1, 0}; Point(3) = {3, 1.2, 0}; Point(4) = {0, 1.2, 0};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
Transfinite Curve {1, 3} = 6 * n + 1; Transfinite Curve {2, 4} = n / 2 + 1;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4}; Physical Surface("inside") = {1};
