"""Every case of the physics specification that this code covers, with its expected number: `hazard-ms validate`."""
