// SPDX-License-Identifier: Apache-2.0
// Quarters of two rings that touch at r = 1.5 m (and, with a gap, do not) on meshes of their own.
DefineConstant[ inner = 12, outer = 16, gap = 0 ];
Point(1)={0,0,0};
For b In {0:1}
  n = b == 0 ? inner : outer; p = 10 + 10*b; r = b == 0 ? 1 : 1.5 + gap; s = r + 0.5;
  Point(p)={r,0,0}; Point(p+1)={s,0,0}; Point(p+2)={0,s,0}; Point(p+3)={0,r,0};
  Line(p)={p,p+1}; Circle(p+1)={p+1,1,p+2}; Line(p+2)={p+2,p+3}; Circle(p+3)={p+3,1,p};
  Curve Loop(p)={p,p+1,p+2,p+3}; Plane Surface(b+1)={p};
  Transfinite Curve {p,p+2}=5; Transfinite Curve {p+1,p+3}=n+1; Transfinite Surface{b+1}; Recombine Surface{b+1};
EndFor
Physical Curve("hole")={13}; Physical Curve("rim")={21}; Physical Curve("x")={10,20}; Physical Curve("y")={12,22};
Physical Curve("between")={11,23}; Physical Surface("rings")={1,2};
