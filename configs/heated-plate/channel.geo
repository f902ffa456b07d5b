// SPDX-License-Identifier: Apache-2.0
// Channel over a plate that reaches from x = 0 to 1 m; cells are finest at the ends of the plate and at its surface.
DefineConstant[ n = 40 ]; // cells along the plate
before = 0.5; length = 1; after = 1.5; height = 0.5;

x[] = {-before, 0, length, length + after};
For i In {0 : 3}
  Point(1 + i) = {x[i], 0, 0};
  Point(5 + i) = {x[i], height, 0};
  Line(20 + i) = {1 + i, 5 + i};
EndFor
For i In {0 : 2}
  Line(1 + i) = {1 + i, 2 + i};
  Line(11 + i) = {5 + i, 6 + i};
  Curve Loop(1 + i) = {1 + i, 21 + i, -(11 + i), -(20 + i)};
  Plane Surface(1 + i) = {1 + i};
EndFor
m = Ceil(n / 2);
Transfinite Curve {1, 11} = m + 1 Using Progression 0.95^(40 / n);
Transfinite Curve {2, 12} = n + 1 Using Bump 0.25;
Transfinite Curve {3, 13} = m + 1 Using Progression 1.08^(40 / n);
Transfinite Curve {20 : 23} = m + 1 Using Progression 1.08^(40 / n);
Transfinite Surface {1 : 3};
Recombine Surface {1 : 3};
Physical Curve("inlet") = {20};
Physical Curve("outlet") = {23};
Physical Curve("top") = {11 : 13};
Physical Curve("floor") = {1, 3};
Physical Curve("plate") = {2};
Physical Surface("fluid") = {1 : 3};
