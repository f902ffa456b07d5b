// SPDX-License-Identifier: Apache-2.0
// Two squares beside each other that share no points, each with a patch of its own at x = 1.
DefineConstant[ left = 4, right = 4 ];
For b In {0:1}
  n = b == 0 ? left : right; p = 4*b;
  Point(p+1)={b,0,0}; Point(p+2)={b+1,0,0}; Point(p+3)={b+1,1,0}; Point(p+4)={b,1,0};
  Line(p+1)={p+1,p+2}; Line(p+2)={p+2,p+3}; Line(p+3)={p+3,p+4}; Line(p+4)={p+4,p+1};
  Curve Loop(b+1)={p+1,p+2,p+3,p+4}; Plane Surface(b+1)={b+1};
  Transfinite Curve {p+1:p+4}=n+1; Transfinite Surface{b+1}; Recombine Surface{b+1};
EndFor
Physical Curve("x0")={4}; Physical Curve("joint-left")={2}; Physical Curve("joint-right")={8}; Physical Curve("x2")={6};
Physical Curve("sides")={1,3,5,7}; Physical Surface("both")={1,2};
