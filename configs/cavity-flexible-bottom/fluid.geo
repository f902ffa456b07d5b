// SPDX-License-Identifier: Apache-2.0
// A unit square; inlet and outlet are strips of 1/8 below the lid.
DefineConstant[ n = 32 ]; // cells per side, a multiple of 8
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 0.875, 0}; Point(4) = {1, 1, 0};
Point(5) = {0, 1, 0}; Point(6) = {0, 0.875, 0};
For i In {1 : 6}
  Line(i) = {i, i % 6 + 1};
EndFor
Line(7) = {6, 3};
Transfinite Curve {1, 4, 7} = n + 1;
Transfinite Curve {2, 6} = Round(0.875 * n) + 1;
Transfinite Curve {3, 5} = Round(0.125 * n) + 1;
Curve Loop(1) = {1, 2, -7, 6}; Curve Loop(2) = {7, 3, 4, 5};
For i In {1 : 2}
  Plane Surface(i) = {i};
  Transfinite Surface {i};
  Recombine Surface {i};
EndFor
Physical Curve("bottom") = {1};
Physical Curve("walls") = {2, 6};
Physical Curve("outlet") = {3};
Physical Curve("lid") = {4};
Physical Curve("inlet") = {5};
Physical Surface("fluid") = {1, 2};
