// SPDX-License-Identifier: Apache-2.0
// Half a meter of the wall of a pipe of radii 1 and 2.
DefineConstant[ n = 4 ];
Point(1) = {1, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {2, 0.5, 0}; Point(4) = {1, 0.5, 0};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
Transfinite Curve {1, 3} = n + 1; Transfinite Curve {2, 4} = n / 2 + 1;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4}; Physical Surface("inside") = {1};
