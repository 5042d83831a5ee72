//! stub
use crate::real::*;
pub fn disc(xi: [Real; 2]) -> [Real; 2] { let r = sqrt(xi[0]); let p = 2.0*PI*xi[1]; [r*cos(p), r*sin(p)] }
pub fn cosine_hemisphere(xi: [Real; 2]) -> Vec3 { let [x,y]=disc(xi); Vec3::new(x,y,safe_sqrt(1.0-x*x-y*y)) }
pub fn sphere(xi: [Real; 2]) -> Vec3 { let z=1.0-2.0*xi[0]; let r=safe_sqrt(1.0-z*z); let p=2.0*PI*xi[1]; Vec3::new(r*cos(p),r*sin(p),z) }
pub fn cone(omc: Real, xi: [Real; 2]) -> Vec3 { let h=omc*xi[0]; let r=safe_sqrt(h*(2.0-h)); let p=2.0*PI*xi[1]; Vec3::new(r*cos(p),r*sin(p),1.0-h) }
pub fn triangle(xi: [Real; 2]) -> [Real; 2] { let s=sqrt(xi[0]); [s*(1.0-xi[1]), s*xi[1]] }
pub fn tent(r: Real, x: Real) -> Real { if x<0.5 { r*(sqrt(2.0*x)-1.0)} else { r*(1.0-sqrt(2.0*(1.0-x)))} }
pub fn tent_pdf(r: Real, x: Real) -> Real { let a=x.abs()/r; if a<1.0 {(1.0-a)/r} else {0.0} }
pub fn gaussian(r: Real, _s: Real, x: Real) -> Real { tent(r,x) }
pub fn gaussian_pdf(r: Real, _s: Real, x: Real) -> Real { tent_pdf(r,x) }
